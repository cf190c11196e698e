#include "kinect/usb_place.hpp"

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

void plug(const TemporaryFolder& folder, const std::string& place, const std::string& product,
          int address) {
  const auto device = folder.path() / place;
  put(device / "idVendor", "045e\n");
  put(device / "idProduct", product + "\n");
  put(device / "busnum", "1\n");
  put(device / "devnum", std::to_string(address) + "\n");
}

TEST(UsbPlace, IsThatOfTheCamera) {
  const TemporaryFolder folder;
  plug(folder, "1-1.2.1", "02b0", 3);  // the motor
  plug(folder, "1-1.2.2", "02ae", 5);
  plug(folder, "1-1.2.3", "02ad", 4);  // the microphones
  EXPECT_EQ(usb_place(0, folder.path()), "usb-1-1.2.2");
  EXPECT_EQ(usb_place(1, folder.path()), "");
}

TEST(UsbPlace, CountsCamerasByTheirAddress) {
  const TemporaryFolder folder;
  plug(folder, "1-1.3", "02bf", 12);
  plug(folder, "1-1.4", "02ae", 9);
  EXPECT_EQ(usb_place(0, folder.path()), "usb-1-1.4");
  EXPECT_EQ(usb_place(1, folder.path()), "usb-1-1.3");
}

TEST(UsbPlace, IsUnknownWhereLinuxShowsNothing) {
  const TemporaryFolder folder;
  EXPECT_EQ(usb_place(0, folder.path()), "");
  EXPECT_EQ(usb_place(0, folder.path() / "none"), "");
}

}  // namespace
}  // namespace octurn
