#include "doctor/turn_checks.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace octurn {
namespace {

using nlohmann::json;
using State = Finding::State;

TurnFinding finding_of(const char* check, const TurnMeasurement& turn,
                       const StepperSettings& settings = {}) {
  for (TurnFinding& one : check_turn(turn, settings)) {
    if (one.finding.check == check) {
      return one;
    }
  }
  ADD_FAILURE() << "no finding " << check;
  return {};
}

TEST(CheckTurn, FindsNothingWrongWithinWhatTheSensorIsWrongBy) {
  for (const TurnFinding& one :
       check_turn({.turn_deg = 361, .play_deg = 0.4, .return_deg = -0.4}, {})) {
    EXPECT_EQ(one.finding.state, State::ok) << one.finding.name;
    EXPECT_EQ(one.set, json::object()) << one.finding.name;
  }
}

TEST(CheckTurn, TellsTheGearThatMakesATurnWhole) {
  const TurnFinding turn = finding_of("turn-whole", {.turn_deg = 270});
  EXPECT_EQ(turn.finding.state, State::fault);
  EXPECT_EQ(turn.finding.measured, "came out as 270.0 degrees");
  EXPECT_EQ(turn.finding.advice, "Set gear_ratio to 1.333.");
  EXPECT_EQ(turn.set, json({{"gear_ratio", 1.333}}));
  // A ratio close to 4 is rounded to 4, as gears have whole teeth.
  EXPECT_EQ(finding_of("turn-whole", {.turn_deg = 269.7}, {.gear_ratio = 3}).set,
            json({{"gear_ratio", 4}}));
}

TEST(CheckTurn, BlamesTheMicrostepsForAPowerOfTwo) {
  // Set to 4 microsteps while the driver makes 16: the platform turns by a quarter.
  EXPECT_EQ(finding_of("turn-whole", {.turn_deg = 90.2}).set, json({{"microsteps", 16}}));
  EXPECT_EQ(finding_of("turn-whole", {.turn_deg = -720.5}).set, json({{"microsteps", 2}}));
}

TEST(CheckTurn, TurnsTheDirectionRound) {
  EXPECT_EQ(finding_of("turn-direction", {.turn_deg = -360}).set, json({{"reversed", true}}));
  EXPECT_EQ(finding_of("turn-direction", {.turn_deg = -360}, {.reversed = true}).set,
            json({{"reversed", false}}));
}

TEST(CheckTurn, TakesUpMoreThanThePlay) {
  const TurnFinding play = finding_of("turn-play", {.turn_deg = 360, .play_deg = 1.8});
  EXPECT_EQ(play.finding.state, State::warning);
  EXPECT_EQ(play.set, json({{"take_up_steps", 6}}));  // 1.8 degrees are 4 of 800 steps
  EXPECT_EQ(finding_of("turn-play", {.turn_deg = 360, .play_deg = 1.8}, {.take_up_steps = 5}).set,
            json({{"take_up_steps", 11}}));
}

TEST(CheckTurn, TellsOfLostSteps) {
  EXPECT_EQ(finding_of("turn-return", {.turn_deg = 360, .return_deg = -3}).finding.state,
            State::fault);
}

TEST(CheckTurn, BlamesNeitherGearNorPlayForLostSteps) {
  // A motor that slipped by 40 degrees looks like another gear, and like play.
  const TurnMeasurement turn = {.turn_deg = 290, .play_deg = 7.2, .return_deg = -43.2};
  EXPECT_EQ(finding_of("turn-whole", turn).set, json::object());
  EXPECT_EQ(finding_of("turn-play", turn).set, json::object());
  const Finding back = finding_of("turn-return", turn).finding;
  EXPECT_NE(back.advice.find("lower its start speed"), std::string::npos) << back.advice;
}

TEST(CheckTurn, WithdrawsAnAdviceOnPlayThatCannotHelp) {
  const TurnFinding play = finding_of("turn-play", {.turn_deg = 360, .play_deg = 1.8},
                                      {.take_up_steps = 13});  // more than three times the play
  EXPECT_EQ(play.finding.state, State::warning);
  EXPECT_EQ(play.set, json::object());
}

TEST(CheckTurn, SaysForHowLongThePlatformSwings) {
  const TurnMeasurement turn = {.turn_deg = 360, .swings_for_s = 0.5};
  EXPECT_EQ(finding_of("turn-still", turn).finding.measured, "swings for 0.8 s after a move");
  EXPECT_EQ(finding_of("turn-still", turn).finding.state, State::ok);
  EXPECT_EQ(finding_of("turn-still", {.turn_deg = 360, .swings_for_s = 2}).finding.state,
            State::warning);
}

TEST(CheckMotion, IsContentWithTwiceTheTorqueThatIsNeeded) {
  EXPECT_EQ(check_motion({.fastest = 2.83}, {}).finding.state, State::ok);
  EXPECT_EQ(check_motion({.fastest = 1.42, .lost_at = 2}, {}).finding.state, State::ok);
}

TEST(CheckMotion, ProposesSpeedsWithAMarginOtherwise) {
  const TurnFinding motion = check_motion({.fastest = 0.5, .lost_at = 0.707}, {});
  EXPECT_EQ(motion.finding.state, State::warning);
  EXPECT_NEAR(motion.set["speed_deg_per_s"].get<double>(), 90 * 0.5 / std::sqrt(2), 1e-9);
  EXPECT_NEAR(motion.set["start_speed_deg_per_s"].get<double>(), 18 * 0.5 / std::sqrt(2), 1e-9);
  EXPECT_NEAR(motion.set["acceleration_deg_per_s2"].get<double>(), 67.5 * 0.25 / 2, 1e-9);
  EXPECT_NO_THROW(stepper_settings_from(motion.set));
}

TEST(CheckMotion, SaysWhatToChangeWhereNothingWorks) {
  const Finding motion = check_motion({.lost_at = 0.25}, {}).finding;
  EXPECT_EQ(motion.state, State::fault);
  EXPECT_NE(motion.advice.find("gear"), std::string::npos);
}

TEST(CheckTurn, TellsOfAPlatformThatStandsStill) {
  const auto findings = check_turn({}, {});
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].finding.measured, "the platform stands still");
}

}  // namespace
}  // namespace octurn
