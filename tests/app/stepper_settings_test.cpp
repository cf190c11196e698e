#include "turntable/stepper_settings.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;
using namespace std::chrono_literals;

std::string levels_of(const StepperSettings& settings) {
  std::string levels;
  for (const NamedLine& line : to_gpio_lines(settings)) {
    levels += line.name + (line.high ? "=H " : "=L ");
  }
  return levels;
}

TEST(StepperSettings, AreReadFromEveryKey) {
  const StepperSettings settings =
      stepper_settings_from({{"step_line", "GPIO20"},
                             {"direction_line", "GPIO21"},
                             {"enable_line", "GPIO6"},
                             {"microstep_lines", {"GPIO22", "GPIO23", "GPIO24"}},
                             {"microsteps", 16},
                             {"full_steps", 400},
                             {"gear_ratio", 2.5},
                             {"reversed", true},
                             {"speed_deg_per_s", 45},
                             {"start_speed_deg_per_s", 4.5},
                             {"acceleration_deg_per_s2", 22.5},
                             {"settle_ms", 150},
                             {"idle_release_s", 10},
                             {"take_up_steps", 32}});
  EXPECT_EQ(levels_of(settings), "GPIO20=L GPIO21=L GPIO6=H GPIO22=H GPIO23=H GPIO24=H ");
  EXPECT_TRUE(settings.reversed);
  EXPECT_EQ(settings.idle_release, 10s);
  EXPECT_EQ(settings.take_up_steps, 32);
  const Motion motion = to_motion(settings);
  EXPECT_EQ(motion.steps_per_turn, 400 * 16 * 5 / 2);
  EXPECT_NEAR(motion.start_steps_per_second, 200, 1e-9);
  EXPECT_NEAR(motion.top_steps_per_second, 2000, 1e-9);
  EXPECT_NEAR(motion.ramp_steps_per_second2, 1000, 1e-9);
  EXPECT_EQ(motion.settle_time, 150ms);
}

TEST(StepperSettings, AreQuarterStepsOfACommonMotorWhereNothingIsSaid) {
  const StepperSettings settings = stepper_settings_from(json::object());
  EXPECT_EQ(to_motion(settings).steps_per_turn, 800);
  EXPECT_EQ(levels_of(settings), "GPIO17=L GPIO27=L GPIO5=H ");
}

/// The levels of the driver's inputs, in the order of its datasheet's table.
std::string microstep_levels(StepperDriver driver, int microsteps, int inputs) {
  const std::vector<std::string> names = {"a", "b", "c"};
  const StepperSettings settings{.lines = {.microsteps = {names.begin(), names.begin() + inputs}},
                                 .driver = driver,
                                 .microsteps = microsteps};
  std::string levels;
  for (const NamedLine& line : to_gpio_lines(settings)) {
    levels += line.name.size() == 1 ? (line.high ? "H" : "L") : "";
  }
  return levels;
}

TEST(StepperSettings, SetMicrostepsAsTheDatasheetsHaveThem) {
  using Table = std::vector<std::pair<int, std::string>>;
  // A4988 datasheet, table 1: MS1, MS2, MS3.
  for (const auto& [microsteps, levels] :
       Table{{1, "LLL"}, {2, "HLL"}, {4, "LHL"}, {8, "HHL"}, {16, "HHH"}}) {
    EXPECT_EQ(microstep_levels(StepperDriver::a4988, microsteps, 3), levels);
  }
  // DRV8825 datasheet, table 1: MODE0, MODE1, MODE2.
  for (const auto& [microsteps, levels] :
       Table{{1, "LLL"}, {2, "HLL"}, {4, "LHL"}, {8, "HHL"}, {16, "LLH"}, {32, "HLH"}}) {
    EXPECT_EQ(microstep_levels(StepperDriver::drv8825, microsteps, 3), levels);
  }
  // TMC2209 datasheet, section 3.3: MS1, MS2.
  for (const auto& [microsteps, levels] : Table{{8, "LL"}, {16, "HH"}, {32, "HL"}, {64, "LH"}}) {
    EXPECT_EQ(microstep_levels(StepperDriver::tmc2209, microsteps, 2), levels);
  }
}

TEST(StepperSettings, KnowWhichMicrostepsADriverMakes) {
  EXPECT_EQ(
      to_motion(stepper_settings_from({{"driver", "DRV8825"}, {"microsteps", 32}})).steps_per_turn,
      6400);
  const json tmc2209 = {{"driver", "TMC2209"}, {"microsteps", 64}, {"microstep_lines", {"a", "b"}}};
  EXPECT_EQ(to_motion(stepper_settings_from(tmc2209)).steps_per_turn, 12800);
  const Error error = error_thrown_by([] { stepper_settings_from({{"driver", "TMC2209"}}); });
  EXPECT_NE(std::string(error.what()).find("8, 16, 32, 64"), std::string::npos) << error.what();
}

TEST(StepperSettings, TurnA28BYJ48ByItsHalfSteps) {
  EXPECT_EQ(
      to_motion(stepper_settings_from({{"full_steps", 4096}, {"microsteps", 1}})).steps_per_turn,
      4096);
}

TEST(StepperSettings, RoundATurnToWholeSteps) {
  EXPECT_EQ(to_motion({.gear_ratio = 60.0 / 17}).steps_per_turn, 2824);  // 2823.53
}

TEST(StepperSettings, AreAlsoReadInStepsAsVersion01WroteThem) {
  const json in_steps = {{"gear_ratio", 2},
                         {"speed_steps_per_s", 800},
                         {"start_speed_steps_per_s", 100},
                         {"ramp_steps_per_s2", 500}};
  const Motion motion = to_motion(stepper_settings_from(in_steps));
  EXPECT_NEAR(motion.start_steps_per_second, 100, 1e-9);
  EXPECT_NEAR(motion.top_steps_per_second, 800, 1e-9);
  EXPECT_NEAR(motion.ramp_steps_per_second2, 500, 1e-9);
  json both = in_steps;
  both["speed_deg_per_s"] = 100;
  EXPECT_EQ(stepper_settings_from(both).speed_deg_per_second, 100);
}

TEST(StepperSettings, TurnThePlatformAlikeWithAnyGearAndDriver) {
  const auto degrees_per_second = [](const json& object) {
    const Motion motion = to_motion(stepper_settings_from(object));
    return motion.top_steps_per_second * 360 / motion.steps_per_turn;
  };
  EXPECT_NEAR(degrees_per_second(json::object()), 90, 1e-9);
  EXPECT_NEAR(degrees_per_second({{"microsteps", 16}}), 90, 1e-9);
  EXPECT_NEAR(degrees_per_second({{"gear_ratio", 4}}), 90, 1e-9);
  // 5,000 pulses a second are the most.
  EXPECT_NEAR(degrees_per_second({{"microsteps", 16}, {"gear_ratio", 10}}), 56.25, 1e-9);
}

TEST(StepperSettings, StartNoFasterThanTheyGo) {
  EXPECT_EQ(stepper_settings_from({{"speed_deg_per_s", 9}}).start_speed_deg_per_second, 9);
  EXPECT_EQ(stepper_settings_from({{"speed_steps_per_s", 40}, {"microsteps", 8}})
                .start_speed_deg_per_second,
            9);
}

TEST(StepperSettings, NameTheKeyThatIsWrong) {
  const std::vector<std::pair<const char*, json>> wrong = {
      {"step_line", 17},         {"direction_line", "GPIO17"},
      {"enable_line", "GPIO27"}, {"microstep_lines", {"GPIO22"}},
      {"microstep_lines", "a"},  {"microstep_lines", {"GPIO22", "GPIO23", "GPIO22"}},
      {"microsteps", 3},         {"microsteps", 32},
      {"full_steps", 4097},      {"driver", "L298"},
      {"full_steps", 0},         {"gear_ratio", 0},
      {"gear_ratio", 0.001},     {"reversed", 1},
      {"speed_deg_per_s", 0},    {"start_speed_deg_per_s", 91},
      {"speed_steps_per_s", 0},  {"acceleration_deg_per_s2", 0},
      {"ramp_steps_per_s2", 0},  {"settle_ms", -1},
      {"idle_release_s", 9},     {"take_up_steps", 801},
      {"steps_line", "GPIO17"}};
  for (const auto& [key, value] : wrong) {
    const Error error = error_thrown_by([&, key = key, value = value] {
      stepper_settings_from({{key, value}});
    });
    EXPECT_EQ(error.code(), ErrorCode::bad_config);
    EXPECT_NE(std::string(error.what()).find(std::string("\"turntable.") + key + "\""),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace octurn
