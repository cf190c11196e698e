#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "camera/lasers.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

TEST(ReleasedLines, AreRefusedWhereTheKernelKeepsThemHigh) {
  for (const std::string driver : {"pinctrl_bcm2835", "pinctrl_rp1"}) {
    const TemporaryFolder sys;
    const auto folder = sys.path() / "module" / driver / "parameters";
    expect_released_lines_to_fall(sys.path());  // an older kernel has no such parameter
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "persist_gpio_outputs") << "N\n";
    expect_released_lines_to_fall(sys.path());
    std::ofstream(folder / "persist_gpio_outputs") << "Y\n";
    const Error error = error_thrown_by([&] { expect_released_lines_to_fall(sys.path()); });
    EXPECT_EQ(error.code(), ErrorCode::sensor_failed);
    EXPECT_NE(std::string(error.what()).find(driver), std::string::npos) << error.what();
    EXPECT_NE(error.hint().find("strict_gpiod"), std::string::npos) << error.hint();
  }
}

}  // namespace
}  // namespace octurn
