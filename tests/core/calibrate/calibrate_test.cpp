#include "octurn/calibrate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "calibrate/optics_solver.hpp"
#include "core/calibrate/rendered_turn.hpp"
#include "octurn/quality.hpp"

namespace octurn {
namespace {

// Required accuracy of a Kinect with eight stops.
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

// From a pose so far off, the box's sides, 12 mm high, do not overlap themselves between stops.
TEST(Calibrate, FindsTheAxisUnderAFlatBoxThatWasTold28MillimetresBeside) {
  CalibrationTurn turn = rendered_turn(block({0.12, 0.08, 0.012}), 8);
  turn.platform_from_sensor = wrong_pose({0.02, 0.02, 0}, {1, 0.5, 0}, 3);
  const CalibrationReport report = calibrate(turn);
  EXPECT_TRUE(report.accepted) << report.reason;
  EXPECT_LT(axis_error(report.platform_from_sensor).position_mm, 0.3);
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
  const Parameters& values = report.findings[0].parameters;
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values.at("stop"), Parameters::mapped_type(5.0));
  EXPECT_NEAR(std::get<double>(values.at("off_deg")), 1.8, 0.3);
}

TEST(Calibrate, SolvesThePoseWithTheAnglesOfAPlatformThatSlippedTwice) {
  std::vector<double> offsets(24, 0.0);
  std::fill(offsets.begin() + 7, offsets.end(), radians_from_degrees(-10));
  std::fill(offsets.begin() + 16, offsets.end(), radians_from_degrees(-14));
  const CalibrationReport report = calibrate(rendered_turn(figure(), 24, offsets));
  ASSERT_EQ(report.findings.size(), 2U);
  EXPECT_EQ(report.findings[0].stop, 7);
  EXPECT_EQ(report.findings[1].stop, 16);
  ASSERT_EQ(report.slipped.size(), 24U);
  for (std::size_t stop = 0; stop < 24; ++stop) {
    EXPECT_NEAR(degrees_from_radians(report.slipped[stop]), degrees_from_radians(offsets[stop]),
                0.2)
        << stop;
  }
  EXPECT_TRUE(report.accepted) << report.reason;
  EXPECT_FALSE(report.confirms_told()) << "the angles are not the configured ones";
  EXPECT_LT(axis_error(report.platform_from_sensor).position_mm, 0.3);
}

/// A turn whose platform never moves.
CalibrationTurn still_turn(const Shape& object, std::size_t stops) {
  CalibrationTurn turn = rendered_turn(object, stops);
  std::vector<DepthFrame> frames;
  std::mt19937 random(3);
  for (std::size_t stop = 0; stop < stops; ++stop) {
    frames.push_back(rendered_frame(object, 0, random));
  }
  turn.read = [frames = std::move(frames)](std::size_t stop) { return frames[stop]; };
  return turn;
}

TEST(Calibrate, RefusesAPlatformThatDidNotTurnAndBlamesNoLens) {
  for (const Shape& object : {figure(), moved(block({0.12, 0.08, 0.012}), {0.02, 0, 0})}) {
    for (const std::size_t stops : {8U, 12U}) {
      const CalibrationReport report = calibrate(still_turn(object, stops));
      EXPECT_FALSE(report.accepted);
      EXPECT_NE(report.reason.find("the platform did not turn"), std::string::npos)
          << report.reason;
      ASSERT_EQ(report.findings.size(), 1U);
      EXPECT_EQ(report.findings[0].code, "still");
    }
  }
}

TEST(Calibrate, TakesAnObjectOfRevolutionThatTurnedForNoPlatformThatStoodStill) {
  for (CalibrationTurn turn :
       {rendered_turn(ball({0, 0, 0.05}, 0.05), 8), still_turn(ball({0, 0, 0.05}, 0.05), 8)}) {
    turn.platform_from_sensor = wrong_pose({0.004, -0.003, 0.002}, {1, 0, 0}, 0.8);
    const CalibrationReport report = calibrate(turn);
    EXPECT_TRUE(report.accepted) << report.reason;
  }
}

/// A turn during which the object moves on the platform: shifted by `by` metres from stop `from`
/// on.
CalibrationTurn turn_with_move(std::size_t stops, std::size_t from, const Eigen::Vector3d& by) {
  CalibrationTurn turn = rendered_turn(figure(), stops);
  const CalibrationTurn after = rendered_turn(moved(figure(), by), stops);
  turn.read = [before = turn.read, after = after.read, from](std::size_t stop) {
    return stop < from ? before(stop) : after(stop);
  };
  return turn;
}

TEST(Calibrate, TellsThatTheObjectMovedAndByHowMuch) {
  const CalibrationReport report = calibrate(turn_with_move(12, 7, {0.003, -0.002, 0}));
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].code, "moved");
  // The object moves by 3.6 mm. The axis is first solved as if nothing had moved and absorbs a part
  // of it; the measurement of the move must restore that part.
  const std::string& detail = report.findings[0].detail;
  EXPECT_NE(detail.find("between stops 6 and 7"), std::string::npos) << detail;
  EXPECT_NEAR(std::stod(detail.substr(detail.find(" by ") + 4)), 3.6, 0.5) << detail;
  const Parameters& values = report.findings[0].parameters;
  ASSERT_EQ(values.size(), 3U);
  EXPECT_EQ(values.at("from_stop"), Parameters::mapped_type(6.0));
  EXPECT_EQ(values.at("to_stop"), Parameters::mapped_type(7.0));
  EXPECT_NEAR(std::get<double>(values.at("shift_mm")), 3.6, 0.5);
}

TEST(Calibrate, SeesInOneMoreLookAtTheFirstAngleThatTheObjectMovedAtTheEnd) {
  CalibrationTurn turn = turn_with_move(12, 12, {0, 0, 0});
  turn.angles.push_back(turn.angles.front());
  std::mt19937 random(7);
  const DepthFrame last = rendered_frame(moved(figure(), {0.004, 0, 0}), 0, random);
  turn.read = [stops = turn.read, last](std::size_t stop) {
    return stop < 12 ? stops(stop) : last;
  };
  const CalibrationReport report = calibrate(turn);
  ASSERT_EQ(report.findings.size(), 1U);
  EXPECT_EQ(report.findings[0].code, "moved");
  EXPECT_NE(report.findings[0].detail.find("between stops 11 and 12"), std::string::npos)
      << report.findings[0].detail;
}

/// The same turn seen by a sensor with a smooth error pattern whose waves are some 130 pixels long.
/// @param size  root mean square, units of disparity
CalibrationTurn with_pattern(CalibrationTurn turn, double size = 0.8) {
  turn.read = [size, read = turn.read](std::size_t stop) {
    DepthFrame frame = read(stop);
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
      const auto u = static_cast<double>(i % 640);
      const auto v = static_cast<double>(i / 640);
      const double error = size * (std::sin(u / 21 + 1) + std::sin(v / 17 + u / 40));
      const double depth = frame.depth[i] * 0.0001;
      frame.depth[i] =
          frame.depth[i] == 0
              ? std::uint16_t{0}
              : static_cast<std::uint16_t>(std::lround(1e4 / (1 / depth + error / 345.489)));
    }
    return frame;
  };
  return turn;
}

TEST(Calibrate, AdvisesToFlattenASensorWhosePatternShowsOnThePlatform) {
  CalibrationTurn turn = with_pattern(rendered_turn(figure(), 8));
  const auto has_no_map = [](const CalibrationReport& report) {
    return std::ranges::find(report.findings, "no-map", &CalibrationFinding::code) !=
           report.findings.end();
  };
  EXPECT_TRUE(has_no_map(calibrate(turn)));
  turn.has_sensor_map = true;
  EXPECT_FALSE(has_no_map(calibrate(turn)));
}

TEST(Calibrate, TrustsAnUnevenPlatformLessAboutTheAxis) {
  const auto right = rendered_turn(figure(), 24);
  const CalibrationReport even = calibrate(right);
  const CalibrationReport uneven = calibrate(with_pattern(right));
  EXPECT_LE(degrees_from_radians(even.direction_sigma), 0.02);
  EXPECT_GT(degrees_from_radians(uneven.direction_sigma), 0.025);
}

TEST(Calibrate, TellsThatThePlatformIsNotSquareToItsShaft) {
  const Eigen::Vector3d normal =
      Eigen::AngleAxisd(radians_from_degrees(0.6), Eigen::Vector3d(1, 2, 0).normalized()) *
      Eigen::Vector3d::UnitZ();
  for (const CalibrationTurn& turn : {rendered_turn(figure(), 12, {}, normal),
                                      with_pattern(rendered_turn(figure(), 12, {}, normal))}) {
    const CalibrationReport report = calibrate(turn);
    const auto wobble = std::ranges::find(report.findings, "wobble", &CalibrationFinding::code);
    ASSERT_NE(wobble, report.findings.end());
    constexpr std::string_view before = "the platform's surface tilts by ";
    ASSERT_TRUE(wobble->detail.starts_with(before)) << wobble->detail;
    // Depths are rounded to 0.1 mm, which tilts a plane over the platform's 30 cm by at most 0.02
    // degrees.
    EXPECT_NEAR(std::stod(wobble->detail.substr(before.size())), 0.6, 0.05);
    EXPECT_NEAR(std::get<double>(wobble->parameters.at("wobble_deg")), 0.6, 0.05);
  }
}

TEST(Calibrate, TakesNoPatternForAWobble) {
  for (const std::size_t stops : {8U, 12U}) {
    const CalibrationReport report = calibrate(with_pattern(rendered_turn(figure(), stops)));
    EXPECT_EQ(std::ranges::count(report.findings, "wobble", &CalibrationFinding::code), 0);
  }
}

/// The report's finding with a code, if there is one.
std::optional<CalibrationFinding> finding(const CalibrationReport& report,
                                          const std::string& code) {
  const auto found = std::ranges::find(report.findings, code, &CalibrationFinding::code);
  return found == report.findings.end() ? std::nullopt : std::optional(*found);
}

/// The sensor of the rendered turns, as told with other optics. @param ratio  true focal length
/// over the told one
Intrinsics told_lens(double ratio, double cx = 320, double cy = 240) {
  return {.fx = Intrinsics().fx / ratio, .fy = Intrinsics().fy / ratio, .cx = cx, .cy = cy};
}

/// Expects the rendered sensor's optics within three sigma, which are at most 0.5 % and 4 pixels.
void expect_true_optics(const CalibrationReport& report) {
  ASSERT_TRUE(report.accepted) << report.reason;
  ASSERT_TRUE(report.optics);
  const SensorOptics& seen = report.optics->value;
  const SensorOptics& sigma = report.optics->sigma;
  EXPECT_LT(sigma.fx, 0.005 * Intrinsics().fx);
  EXPECT_LT(std::max(sigma.cx, sigma.cy), 4);
  EXPECT_NEAR(seen.fx, Intrinsics().fx, 3 * sigma.fx);
  EXPECT_NEAR(seen.cx, Intrinsics().cx, 3 * sigma.cx);
  EXPECT_NEAR(seen.cy, Intrinsics().cy, 3 * sigma.cy);
}

TEST(Calibrate, SolvesAFocalLengthThatIsTwoPerCentOff) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  for (const double ratio : {0.98, 1.02}) {
    turn.intrinsics = told_lens(ratio);
    const CalibrationReport report = calibrate(turn);
    expect_true_optics(report);
    EXPECT_TRUE(report.optics_differ) << ratio;
    EXPECT_FALSE(report.confirms_told()) << ratio;
    EXPECT_LT(report.after, report.before);
    EXPECT_TRUE(report.findings.empty());
  }
}

TEST(Calibrate, SolvesAPrincipalPointThatIsElevenPixelsOff) {
  CalibrationTurn turn = rendered_turn(figure(), 12);
  turn.intrinsics = told_lens(1.01, 311, 246.5);
  const CalibrationReport report = calibrate(turn);
  expect_true_optics(report);
  EXPECT_TRUE(report.optics_differ);
}

TEST(Calibrate, KeepsOpticsThatAreRight) {
  const CalibrationReport report = calibrate(rendered_turn(figure(), 8));
  expect_true_optics(report);
  EXPECT_FALSE(report.optics_differ);
  EXPECT_TRUE(report.confirms_told());
}

// A sensor map from one wall leaves an error of some 0.1 units of disparity.
TEST(Calibrate, SolvesOpticsOfAnUnevenSensorWithItsMap) {
  CalibrationTurn turn = with_pattern(rendered_turn(figure(), 8), 0.1);
  turn.has_sensor_map = true;
  EXPECT_FALSE(calibrate(turn).optics_differ);
  turn.intrinsics = told_lens(1.05);
  EXPECT_TRUE(calibrate(turn).optics_differ);
}

// A pattern moves the principal point by up to 12 pixels, and the focal length by a per cent.
TEST(Calibrate, SolvesOnlyTheFocalLengthOfAnUnevenSensorWithoutAMap) {
  CalibrationTurn turn = with_pattern(rendered_turn(figure(), 24), 0.4);
  turn.intrinsics = told_lens(590.5 / 575.8, 308, 234);
  const CalibrationReport report = calibrate(turn);
  ASSERT_TRUE(report.accepted) << report.reason;
  ASSERT_TRUE(report.optics_differ);
  const SensorOptics& seen = report.optics->value;
  const SensorOptics& sigma = report.optics->sigma;
  EXPECT_NEAR(seen.fx, Intrinsics().fx, 2 * sigma.fx);
  EXPECT_GT(sigma.fx, 0.008 * Intrinsics().fx);
  EXPECT_NEAR(seen.cx, turn.intrinsics.cx, 1e-3);
  EXPECT_NEAR(seen.cy, turn.intrinsics.cy, 1e-3);
  EXPECT_NEAR(seen.k1, 0, 1e-5);
  EXPECT_EQ(sigma.cx, 8) << "as known as before";
}

TEST(Calibrate, KeepsOpticsThatAreRightOfAnUnevenSensorWithoutAMap) {
  const CalibrationReport report = calibrate(with_pattern(rendered_turn(figure(), 24), 0.4));
  ASSERT_TRUE(report.accepted) << report.reason;
  ASSERT_TRUE(report.optics);
  EXPECT_NEAR(report.optics->value.fx, Intrinsics().fx, 2 * report.optics->sigma.fx);
  EXPECT_FALSE(report.optics_differ);
}

/// Optics that were known to a focal length's sigma of `share`, and to `pixels` of the centre.
SolvedOptics known_optics(const Intrinsics& lens, double share, double pixels) {
  const double focal = share * lens.fx;
  return {.value = {.fx = lens.fx, .fy = lens.fy, .cx = lens.cx, .cy = lens.cy, .k2 = 0.01},
          .sigma = {.fx = focal, .fy = focal, .cx = pixels, .cy = pixels, .k1 = 0.02, .k2 = 0.1}};
}

TEST(Calibrate, SolvesNoOpticsOfAnUnevenSensorThatAreKnownOrSeenFromFewStops) {
  CalibrationTurn turn = with_pattern(rendered_turn(figure(), 7));
  turn.intrinsics = told_lens(590.5 / 575.8);
  EXPECT_FALSE(calibrate(turn).optics);
  turn = with_pattern(rendered_turn(figure(), 8));
  turn.intrinsics = told_lens(590.5 / 575.8);
  EXPECT_TRUE(calibrate(turn).optics);
  turn.optics = known_optics(turn.intrinsics, 0.005, 8);
  EXPECT_FALSE(calibrate(turn).optics);
}

TEST(Calibrate, SolvesNoOpticsThatAreKnownWithoutSigmas) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.intrinsics = told_lens(1.02);
  turn.optics = known_optics(turn.intrinsics, 0, 0);
  const CalibrationReport report = calibrate(turn);
  EXPECT_FALSE(report.optics);
  EXPECT_FALSE(report.optics_differ);
}

TEST(Calibrate, ReplacesKnownOpticsThatAreFarOff) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.intrinsics = told_lens(1.02);
  turn.optics = known_optics(turn.intrinsics, 0.012, 8);
  turn.optics->value.k1 = -0.0625;  // taken out of the images
  const CalibrationReport report = calibrate(turn);
  EXPECT_TRUE(report.optics_differ);
  expect_true_optics(report);
  EXPECT_NEAR(report.optics->value.k1, -0.0625, 3 * report.optics->sigma.k1);
  EXPECT_EQ(report.optics->value.k2, 0.01) << "no turn shows it";
}

TEST(Calibrate, CombinesWhatWasKnownWithWhatATurnShowsByTheirSigmas) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.intrinsics = told_lens(1.004);
  turn.optics = known_optics(turn.intrinsics, 0.015, 8);
  const CalibrationReport loose = calibrate(turn);
  EXPECT_TRUE(loose.optics_differ) << "the turn tells far more than was known";
  turn.optics = known_optics(turn.intrinsics, 0.0005, 0.5);
  const CalibrationReport tight = calibrate(turn);
  ASSERT_TRUE(loose.optics && tight.optics);
  EXPECT_FALSE(tight.optics_differ);
  EXPECT_LT(tight.optics->sigma.fx, loose.optics->sigma.fx);
  const double told = turn.intrinsics.fx;
  EXPECT_LT(std::abs(tight.optics->value.fx - told), std::abs(loose.optics->value.fx - told));
}

// Ten units drawn from the spread of published ones, and a length known to 0.1 %.
TEST(Calibrate, StatesASizeErrorThatCoversTheTrueOneOfMostUnits) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  std::mt19937 random(42);
  const auto drawn = [&](double sigma) {  // uniform: std::normal_distribution differs by library
    return sigma * std::sqrt(3.0) * (2 * static_cast<double>(random()) / 4294967295.0 - 1);
  };
  int covered = 0;
  int narrow = 0;
  for (int unit = 0; unit < 10; ++unit) {
    turn.intrinsics = told_lens(1 + drawn(0.015), 320 + drawn(8), 240 + drawn(8));
    const double scale = 1 + drawn(0.001);
    const CalibrationReport report = calibrate(turn);
    ASSERT_TRUE(report.accepted) << unit << ": " << report.reason;
    Scan scan{.intrinsics = turn.intrinsics, .scale_sigma = 0.0015, .shots = {Shot{}}};
    if (report.optics_differ) {
      scan.solved = SolvedPose{.optics = report.optics};
    }
    const double used = report.optics_differ ? report.optics->value.fx : turn.intrinsics.fx;
    const double true_error = 0.15 * std::abs(scale * Intrinsics().fx / used - 1);
    const auto stated = expected_size_error(scan, {0.05, 0.05, 0.15}, report.optics);
    ASSERT_TRUE(stated);
    narrow += stated->error < 0.002 ? 1 : 0;
    covered += true_error <= stated->error ? 1 : 0;
  }
  EXPECT_GE(covered, 9);
  EXPECT_GE(narrow, 8) << "a statement that covers everything says nothing";
}

TEST(Calibrate, SaysWhatOpticsThatItCouldNotApplyMayCost) {
  const CalibrationFinding unused =
      describe_unused_optics({.fx = 590.195, .cx = 320, .cy = 240}, Intrinsics());
  EXPECT_EQ(unused.code, "optics");
  EXPECT_NEAR(std::get<double>(unused.parameters.at("size_share")), 0.025, 1e-6);
  EXPECT_NE(unused.detail.find("sizes may be wrong by 2.5 %"), std::string::npos) << unused.detail;
}

TEST(Calibrate, TellsAFocalLengthThatNoKinectHas) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.intrinsics = told_lens(1.09);
  const CalibrationReport report = calibrate(turn);
  EXPECT_FALSE(report.optics_differ);
  const auto wrong = finding(report, "focal-length");
  ASSERT_TRUE(wrong);
  EXPECT_NE(wrong->detail.find("longer than configured"), std::string::npos) << wrong->detail;
  const Parameters& values = wrong->parameters;
  ASSERT_EQ(values.size(), 3U);
  EXPECT_DOUBLE_EQ(std::get<double>(values.at("told_px")), turn.intrinsics.fx);
  // The prior, of 1.5 %, pulls it towards the told one.
  EXPECT_NEAR(std::get<double>(values.at("seen_px")), Intrinsics().fx, 0.02 * Intrinsics().fx);
}

// With a ball, only the platform's tilt against the axis depends on the focal length.
TEST(Calibrate, AppliesNoOpticsSeenWithABall) {
  EXPECT_FALSE(calibrate(rendered_turn(ball({0.02, 0, 0.05}, 0.05), 8)).optics_differ);
}

TEST(Calibrate, ReadsEachDepthImageOnce) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  std::vector<int> reads(8, 0);
  turn.read = [&reads, read = turn.read](std::size_t stop) {
    ++reads[stop];
    return read(stop);
  };
  EXPECT_TRUE(calibrate(turn).accepted);
  EXPECT_EQ(reads, std::vector<int>(8, 1));
}

}  // namespace
}  // namespace octurn
