#include "calibrate/stop_offsets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/calibrate/views_of.hpp"

namespace octurn {
namespace {

TEST(StopOffsets, AreTheAnglesThatThePlatformStoodFurtherOn) {
  std::vector<double> offsets(12, 0.0);
  offsets[3] = radians_from_degrees(-0.7);
  for (std::size_t stop = 7; stop < offsets.size(); ++stop) {
    offsets[stop] = radians_from_degrees(1.8);
  }
  const TurnViews views = views_of(rendered_turn(figure(), 12, offsets));

  const auto solved = solve_stop_offsets(views, true_platform_from_sensor(), 1);

  ASSERT_TRUE(solved);
  for (std::size_t stop = 0; stop < offsets.size(); ++stop) {
    // Three sigma: 0.4 mm of noise over some hundred readings 40 mm from the axis gives 0.05
    // degrees, at this stop and at the first stop, to which offsets are relative.
    EXPECT_NEAR(degrees_from_radians(solved->offsets[stop]), degrees_from_radians(offsets[stop]),
                0.21)
        << stop;
  }
}

TEST(StopOffsets, AreUnknownOfAnObjectThatLooksTheSameFromAllSides) {
  TurnViews views = views_of(rendered_turn(ball({0, 0, 0.06}, 0.055), 12));
  views.correlation = 10;  // the value of a turn that is read with this step
  EXPECT_FALSE(solve_stop_offsets(views, true_platform_from_sensor(), 1));
}

// Seen edge-on, a plate of 10 mm shows few readings, as the simulator's robot does. Across such a
// stop, the offsets before and after are known relative to each other to 1.3 degrees only.
TEST(StopOffsets, AreKnownOfAnObjectThatIsThinFromSomeSides) {
  const Shape plate = moved(block({0.01, 0.09, 0.08}), {0.01, 0.01, 0});
  TurnViews views = views_of(rendered_turn(plate, 8));
  views.correlation = 8;
  const auto solved = solve_stop_offsets(views, true_platform_from_sensor(), 1);
  ASSERT_TRUE(solved);
  for (const double offset : solved->offsets) {
    EXPECT_NEAR(degrees_from_radians(offset), 0, 1.3);
  }
}

/// Solved offsets that are 0 but for noise with a standard deviation of 0.1 degrees.
StopOffsets noisy_offsets(std::size_t stops) {
  std::mt19937 random(3);
  StopOffsets solved;
  for (std::size_t stop = 0; stop < stops; ++stop) {
    const double unit = static_cast<double>(random()) / 4294967295.0 - 0.5;
    solved.offsets.push_back(stop == 0 ? 0 : radians_from_degrees(0.35 * unit));
  }
  const double sigma = radians_from_degrees(0.1);
  const auto size = static_cast<Eigen::Index>(stops) - 1;
  solved.covariance = Eigen::MatrixXd::Identity(size, size) * sigma * sigma;
  return solved;
}

std::vector<double> even_angles(std::size_t stops) {
  std::vector<double> angles;
  for (std::size_t stop = 0; stop < stops; ++stop) {
    angles.push_back(2 * std::numbers::pi * static_cast<double>(stop) / static_cast<double>(stops));
  }
  return angles;
}

TEST(FindSlips, NamesTheStopOfAStepAndItsSize) {
  StopOffsets solved = noisy_offsets(24);
  for (std::size_t stop = 9; stop < 24; ++stop) {
    solved.offsets[stop] += radians_from_degrees(-1.8);
  }
  const auto findings = find_slips(even_angles(24), solved);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].code, "slip");
  EXPECT_EQ(findings[0].stop, 9);
  ASSERT_TRUE(findings[0].angle);
  EXPECT_NEAR(degrees_from_radians(*findings[0].angle), -1.8, 0.4);
  EXPECT_NE(findings[0].detail.find("stop 9"), std::string::npos) << findings[0].detail;
}

TEST(FindSlips, NamesAStepOfThreeSigmaThatStandsOutOfTheOthers) {
  StopOffsets solved = noisy_offsets(8);
  const double sigma = radians_from_degrees(0.25);  // typical of eight stops
  solved.covariance = Eigen::MatrixXd::Identity(7, 7) * sigma * sigma;
  for (std::size_t stop = 5; stop < 8; ++stop) {
    solved.offsets[stop] += radians_from_degrees(1.4);
  }
  const auto findings = find_slips(even_angles(8), solved);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].stop, 5);
}

// A flat box seen edge-on gives such an error: it grows over two stops and is gone at the next.
TEST(FindSlips, FindsNoneWhereTheOffsetsComeBack) {
  StopOffsets solved = noisy_offsets(24);
  solved.offsets[5] -= radians_from_degrees(0.6);
  solved.offsets[6] -= radians_from_degrees(1.6);
  EXPECT_TRUE(find_slips(even_angles(24), solved).empty());
}

// Two turns of the simulated robot before a sensor with a pattern, on its feet and on its side,
// degrees.
TEST(FindSlips, FindsNoneWhereAPatternMovesManyStops) {
  const std::array<std::array<double, 24>, 2> turns = {{
      {0,    -0.05, 0.30, 0.33, 0.31, 0.69, 0.66, 0.65, 0.63, 0.64, 0.67, 0.76,
       0.56, 0.70,  0.95, 0.85, 0.71, 0.88, 0.97, 0.22, 0.25, 0.19, 0.12, 0.13},
      {0,    -0.55, -0.47, -0.01, 0.71,  0.62,  0.59,  0.65,  0.80,  0.71,  0.56,  0.38,
       0.04, -0.21, -0.13, -0.26, -0.08, -0.00, -0.10, -0.26, -0.11, -0.15, -0.15, 0.07},
  }};
  for (const auto& turn : turns) {
    StopOffsets solved = noisy_offsets(24);
    std::ranges::transform(turn, solved.offsets.begin(),
                           [](double deg) { return radians_from_degrees(deg); });
    EXPECT_TRUE(find_slips(even_angles(24), solved).empty());

    // A platform that slips before the same sensor by more than the pattern's degree is found.
    for (std::size_t stop = 10; stop < 24; ++stop) {
      solved.offsets[stop] -= radians_from_degrees(2);
    }
    const auto findings = find_slips(even_angles(24), solved);
    ASSERT_EQ(findings.size(), 1U);
    EXPECT_EQ(findings[0].stop, 10);
  }
}

TEST(FindSlips, NamesAStepAtTheLastStop) {
  StopOffsets solved = noisy_offsets(12);
  solved.offsets[11] += radians_from_degrees(1.8);
  const auto findings = find_slips(even_angles(12), solved);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].stop, 11);
}

TEST(FindSlips, ReportsATurnThatIsNotWhole) {
  StopOffsets solved = noisy_offsets(24);
  const auto angles = even_angles(24);
  for (std::size_t stop = 0; stop < 24; ++stop) {
    solved.offsets[stop] = -0.25 * angles[stop];  // as a gear ratio wrong by 3 : 4 does
  }
  const auto findings = find_slips(angles, solved);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].code, "turn-not-whole");
  EXPECT_NE(findings[0].detail.find("270"), std::string::npos) << findings[0].detail;
  EXPECT_NE(findings[0].hint.find("1.33"), std::string::npos) << findings[0].hint;
  EXPECT_NEAR(std::get<double>(findings[0].parameters.at("turn_deg")), 270, 1);
}

TEST(FindSlips, NamesEachOfSeveralSteps) {
  StopOffsets solved = noisy_offsets(36);
  std::vector<double> slipped(36, 0.0);
  for (std::size_t stop = 9; stop < 36; ++stop) {
    slipped[stop] = radians_from_degrees(stop < 25 ? -10 : -20);
    solved.offsets[stop] += slipped[stop];
  }
  const auto findings = find_slips(even_angles(36), solved);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].stop, 9);
  EXPECT_EQ(findings[1].stop, 25);
  const std::vector<double> found = slipped_angles(findings, solved);
  ASSERT_EQ(found.size(), 36U);
  for (std::size_t stop = 0; stop < 36; ++stop) {
    EXPECT_NEAR(degrees_from_radians(found[stop]), degrees_from_radians(slipped[stop]), 0.2);
  }
}

TEST(FindSlips, FindsNothingInNoise) {
  EXPECT_TRUE(find_slips(even_angles(24), noisy_offsets(24)).empty());
}

}  // namespace
}  // namespace octurn
