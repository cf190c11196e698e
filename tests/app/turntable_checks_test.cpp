#include "doctor/turntable_checks.hpp"

#include <gtest/gtest.h>

namespace octurn {
namespace {

using State = Finding::State;

HeaderUse header(std::optional<std::string> user_of_dir) {
  return {.label = "pinctrl-bcm2711",
          .lines = {{.name = "GPIO17"}, {.name = "GPIO27", .user = std::move(user_of_dir)}}};
}

TEST(WakeUpsCheck, TellsTheMedianAndTheLongestAndWarnsOfAPulseThatWouldBeLate) {
  using namespace std::chrono_literals;
  const Finding good = check_wake_ups({20us, 60us, 140us}, 500us);
  EXPECT_EQ(good.state, State::ok);
  EXPECT_EQ(good.measured, "3 wake-ups, half of them within 0.06 ms and all within 0.14 ms");
  const Finding late = check_wake_ups({20us, 60us, 1600us}, 500us);
  EXPECT_EQ(late.state, State::warning);
  EXPECT_EQ(late.measured, "3 wake-ups, half of them within 0.06 ms and all within 1.60 ms");
}

TEST(WakeUps, AreCountedAndNeverEarly) {
  using namespace std::chrono_literals;
  const Lateness lateness = measure_wake_ups(5, 100us);
  ASSERT_EQ(lateness.size(), 5U);
  EXPECT_GE(lateness.front(), 0us);
}

TEST(GpioChipCheck, NamesTheChip) {
  EXPECT_EQ(check_gpio_chip(header({})).state, State::ok);
  EXPECT_EQ(check_gpio_chip(header({})).measured, "pinctrl-bcm2711");
}

TEST(GpioChipCheck, SaysWhyThereIsNone) {
  const HeaderState none = Failure{.code = ErrorCode::turntable_missing,
                                   .detail = "this machine has no GPIO header",
                                   .hint = "Use a Raspberry Pi."};
  const Finding chip = check_gpio_chip(none);
  EXPECT_EQ(chip.state, State::fault);
  EXPECT_EQ(chip.measured, "this machine has no GPIO header");
  EXPECT_EQ(chip.advice, "Use a Raspberry Pi.");
  EXPECT_EQ(check_gpio_lines(none, LineOwner::another).state, State::unknown);
}

TEST(GpioLinesCheck, FindsThemFree) {
  const Finding finding = check_gpio_lines(header({}), LineOwner::another);
  EXPECT_EQ(finding.state, State::ok);
  EXPECT_EQ(finding.measured, "GPIO17, GPIO27 free");
}

TEST(GpioLinesCheck, NamesWhoUsesOne) {
  const Finding finding = check_gpio_lines(header("w1-gpio"), LineOwner::this_program);
  EXPECT_EQ(finding.state, State::fault);
  EXPECT_EQ(finding.measured, "GPIO27 in use by w1-gpio");
}

TEST(GpioLinesCheck, KnowsItsOwnLines) {
  EXPECT_EQ(check_gpio_lines(header("octurn"), LineOwner::this_program).state, State::ok);
  EXPECT_EQ(check_gpio_lines(header("octurn"), LineOwner::another).state, State::fault);
}

TEST(GpioLinesCheck, NamesALineThatIsNotThere) {
  HeaderUse use = header({});
  use.lines.push_back({.name = "GPIO99", .exists = false});
  const Finding finding = check_gpio_lines(use, LineOwner::another);
  EXPECT_EQ(finding.state, State::fault);
  EXPECT_EQ(finding.measured, "there is no GPIO99");
}

}  // namespace
}  // namespace octurn
