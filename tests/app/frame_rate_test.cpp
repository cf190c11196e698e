#include "camera/frame_rate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

using Paths = std::vector<std::filesystem::path>;

/// Adds a video4linux device as in sysfs: a link to a USB interface, or to another parent.
void add_device(const TemporaryFolder& sys, const std::string& name, const std::string& parent) {
  const auto interface = sys.path() / "devices" / parent;
  std::filesystem::create_directories(interface);
  const auto folder = sys.path() / "class" / "video4linux" / name;
  std::filesystem::create_directories(folder);
  std::filesystem::create_directory_symlink(interface, folder / "device");
}

TEST(FrameRate, IsAskedOfTheDevicesOfTheUsbCamera) {
  const TemporaryFolder sys;
  add_device(sys, "video0", "usb1/1-1.2/1-1.2:1.0");
  add_device(sys, "video1", "usb1/1-1.2/1-1.2:1.0");
  add_device(sys, "video2", "usb1/1-2/1-2:1.0");
  add_device(sys, "video3", "bcm2835-isp");

  const std::string hub = "/base/scb/pcie@7d500000/pci@0,0/usb@0,0-";
  Paths devices = video_devices(hub + "1.2:1.0-046d:0825", sys.path());
  std::ranges::sort(devices);
  EXPECT_EQ(devices, (Paths{"/dev/video0", "/dev/video1"}));
  EXPECT_EQ(video_devices(hub + "2:1.0-046d:0825", sys.path()), Paths{"/dev/video2"});
  EXPECT_EQ(video_devices(hub + "3:1.0-046d:0825", sys.path()), Paths{});
  EXPECT_EQ(video_devices("/base/soc/i2c0mux/i2c@1/imx219@10", sys.path()), Paths{});
}

TEST(FrameRate, IsUnknownOfWhatIsNoCamera) {
  EXPECT_EQ(fastest_rate_hz({"/dev/null", "/dev/no-such-device"}, 0x47504a4d, 640, 480), 0);
  EXPECT_EQ(video_devices("camera", "/no-such-folder"), Paths{});
}

}  // namespace
}  // namespace octurn
