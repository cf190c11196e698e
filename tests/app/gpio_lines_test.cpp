#include "turntable/gpio_lines.hpp"

#include <gtest/gtest.h>

#include <string>

namespace octurn {
namespace {

TEST(GpioLines, AreFoundByTheirNumberWhateverTheKernelCallsThem) {
  // Debian's bcm2711-rpi-4-b.dtb has SDA1, GPIO_GCLK, SPI_CE1_N and TXD1 for some of these.
  for (unsigned number = 2; number <= 27; ++number) {
    EXPECT_EQ(header_offset("GPIO" + std::to_string(number)), number);
  }
}

TEST(GpioLines, OfOtherNamesAreLeftToTheKernel) {
  for (const char* name :
       {"SDA1", "GPIO0", "GPIO1", "GPIO28", "GPIO02", "GPIO", "GPIO5x", "5", ""}) {
    EXPECT_EQ(header_offset(name), std::nullopt) << name;
  }
}

}  // namespace
}  // namespace octurn
