#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "core/calibrate/rendered_turn.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr std::size_t turn_stops = 24;

/// A turn whose platform turns by `ratio` times the commanded angles.
CalibrationTurn turn_at_ratio(const Shape& object, double ratio) {
  std::vector<double> offsets;
  for (std::size_t stop = 0; stop < turn_stops; ++stop) {
    offsets.push_back((ratio - 1) * 2 * std::numbers::pi * static_cast<double>(stop) /
                      static_cast<double>(turn_stops));
  }
  CalibrationTurn turn = rendered_turn(object, turn_stops, offsets);
  turn.platform_from_sensor = wrong_pose({0.003, -0.002, 0.001}, {1, 0, 0}, 0.5);
  return turn;
}

/// A ring of 7 cm that lies on the platform, 2 cm high.
Shape ring() {
  return [](const Eigen::Vector3d& p) {
    return std::hypot(p.head<2>().norm() - 0.035, p.z() - 0.01) - 0.01;
  };
}

std::string codes(const CalibrationReport& report) {
  std::string codes;
  for (const CalibrationFinding& finding : report.findings) {
    codes += finding.code + " ";
  }
  return codes;
}

TEST(TurnRatio, NamesAPlatformThatTurnsTheOtherWay) {
  const CalibrationReport report = calibrate(turn_at_ratio(figure(), -1));
  EXPECT_FALSE(report.accepted);
  ASSERT_EQ(codes(report), "turn-ratio ") << report.reason;
  EXPECT_EQ(report.findings[0].parameters,
            (Parameters{{"told_deg", 90.0}, {"clockwise_deg", 90.0}}));
  EXPECT_NE(report.findings[0].hint.find("Turn the other way"), std::string::npos);
  EXPECT_EQ(report.reason, report.findings[0].detail);
}

TEST(TurnRatio, NamesARatioThatIsWrongByAWholeNumber) {
  for (const double ratio : {2.0, 0.5, -2.0, 4.0}) {
    const CalibrationReport report = calibrate(turn_at_ratio(figure(), ratio));
    EXPECT_FALSE(report.accepted) << ratio;
    ASSERT_EQ(codes(report), "turn-ratio ") << ratio << ": " << report.reason;
    const Parameters& values = report.findings[0].parameters;
    EXPECT_EQ(values.at(ratio < 0 ? "clockwise_deg" : "turned_deg"),
              Parameters::mapped_type(90 * std::abs(ratio)));
  }
}

TEST(TurnRatio, SuspectsTheTurntableIfNoRatioExplainsTheStops) {
  CalibrationTurn turn = turn_at_ratio(figure(), 1);
  std::vector<std::size_t> order(turn_stops);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), std::mt19937(3));
  turn.read = [order, right = turn.read](std::size_t stop) { return right(order[stop]); };
  const CalibrationReport report = calibrate(turn);
  EXPECT_FALSE(report.accepted);
  EXPECT_EQ(codes(report), "turn-unknown ") << report.reason;
}

TEST(TurnRatio, BlamesNoMotorForARingThatLooksTheSameFromAllSides) {
  for (const double ratio : {1.0, 0.0, -1.0}) {
    const CalibrationReport report = calibrate(turn_at_ratio(ring(), ratio));
    for (const CalibrationFinding& finding : report.findings) {
      EXPECT_EQ(finding.code, "alike") << ratio << ": " << finding.detail;
    }
  }
}

}  // namespace
}  // namespace octurn
