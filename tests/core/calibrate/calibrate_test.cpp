#include "octurn/calibrate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>

#include "core/calibrate/rendered_turn.hpp"

namespace octurn {
namespace {

// What a Kinect must reach with eight stops.
constexpr double position_mm = 0.12;
constexpr double direction_deg = 0.05;

void expect_axis_found(const CalibrationReport& report) {
  EXPECT_TRUE(report.accepted) << report.reason;
  EXPECT_EQ(report.reason, "");
  const AxisError error = axis_error(report.platform_from_sensor);
  EXPECT_LT(error.position_mm, position_mm);
  EXPECT_LT(error.direction_deg, direction_deg);
  EXPECT_LT(error.height_mm, position_mm);
}

std::string reason(const CalibrationTurn& turn) {
  const CalibrationReport report = calibrate(turn);
  EXPECT_FALSE(report.accepted);
  return report.reason;
}

TEST(Calibrate, FindsASensorThatStandsThreeCentimetresAndFiveDegreesFromWhereItWasTold) {
  CalibrationTurn turn = rendered_turn(figure(), 12);
  turn.platform_from_sensor = wrong_pose({0.02, -0.018, 0.013}, {1, -0.4, 0}, 5);

  const CalibrationReport report = calibrate(turn);

  expect_axis_found(report);
  EXPECT_NEAR(degrees_from_radians(report.tilt), 5, 0.1);
  EXPECT_LT(report.after, report.before);
  EXPECT_FALSE(report.confirms_told());
  EXPECT_TRUE(report.findings.empty()) << report.findings.front().detail;
  ASSERT_EQ(report.stop_offsets.size(), 12U);
  EXPECT_EQ(report.stop_offsets.front(), 0);
}

TEST(Calibrate, SeesAnObjectThatStandsBesideTheMiddleFromEightStops) {
  CalibrationTurn turn = rendered_turn(moved(figure(), {0.03, 0.02, 0}), 8);
  turn.platform_from_sensor = wrong_pose({-0.008, 0.01, -0.006}, {0.3, 1, 0}, 1.5);
  expect_axis_found(calibrate(turn));
}

TEST(Calibrate, ConfirmsARigThatIsRight) {
  const CalibrationReport report = calibrate(rendered_turn(figure(), 12));
  expect_axis_found(report);
  EXPECT_TRUE(report.confirms_told());
  EXPECT_TRUE(report.findings.empty()) << report.findings.front().detail;
}

TEST(Calibrate, KeepsTheTurnAboutTheAxisAsTold) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.platform_from_sensor = wrong_pose({0.004, 0, 0}, {0, 0, 1}, 4);
  const CalibrationReport report = calibrate(turn);
  EXPECT_TRUE(report.accepted) << report.reason;
  const Eigen::AngleAxisd change(report.platform_from_sensor.linear() *
                                 turn.platform_from_sensor.linear().transpose());
  EXPECT_LT(degrees_from_radians(std::abs(change.angle() * change.axis().z())), 0.01);
}

TEST(Calibrate, NamesTheStopAtWhichThePlatformSlipped) {
  std::vector<double> offsets(12, 0.0);
  std::fill(offsets.begin() + 5, offsets.end(), radians_from_degrees(1.8));
  const CalibrationReport report = calibrate(rendered_turn(figure(), 12, offsets));
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].code, "slip");
  EXPECT_EQ(report.findings[0].stop, 5);
  EXPECT_NEAR(degrees_from_radians(report.findings[0].angle.value_or(0)), 1.8, 0.3);
}

TEST(Calibrate, RefusesAnEmptyPlatform) {
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  EXPECT_NE(reason(rendered_turn(nothing, 8)).find("too little of an object"), std::string::npos);
}

TEST(Calibrate, RefusesAnObjectOfFiveMillimetres) {
  EXPECT_NE(reason(rendered_turn(ball({0, 0, 0.0025}, 0.0025), 8)).find("too little of an object"),
            std::string::npos);
}

TEST(Calibrate, RefusesTwoStops) {
  EXPECT_NE(reason(rendered_turn(figure(), 2)).find("too few stops"), std::string::npos);
}

TEST(Calibrate, RefusesAPictureWithoutAPlatform) {
  CalibrationTurn turn = rendered_turn(figure(), 2);
  turn.angles = {0, 0.7, 1.4, 2.1};
  turn.read = [](std::size_t) {
    return DepthFrame{.width = 640, .height = 480, .depth = std::vector<std::uint16_t>(640 * 480)};
  };
  EXPECT_NE(reason(turn).find("platform was not found"), std::string::npos);
}

TEST(Calibrate, RefusesAnImageOfAnotherSize) {
  CalibrationTurn turn = rendered_turn(figure(), 4);
  turn.intrinsics.width = 641;
  EXPECT_THROW(calibrate(turn), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
