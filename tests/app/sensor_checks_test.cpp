#include "doctor/sensor_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "octurn/units.hpp"
#include "rig/nominal_pose.hpp"

namespace octurn {
namespace {

using State = Finding::State;
using namespace std::chrono_literals;
using Time = std::chrono::steady_clock::time_point;

constexpr auto period = std::chrono::nanoseconds(33'333'333);
const Box clip{.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}};

SensorSample sample_of(std::vector<Time> times, std::optional<PacketCounts> packets = {}) {
  return {.name = "Kinect v1", .times = std::move(times), .packets = packets};
}

/// Times of 60 frames, one each period, without the missing numbers.
std::vector<Time> every_period_but(const std::vector<int>& missing) {
  std::vector<Time> times;
  for (int i = 0; i < 60; ++i) {
    if (std::ranges::find(missing, i) == missing.end()) {
      times.push_back(Time(1s) + i * period);
    }
  }
  return times;
}

/// A sensor in its nominal pose that sees only a plane. Readings alternate between `noise` metres
/// beyond it and before it, along the ray.
/// @param height  of the plane above the platform, metres
/// @param rise    slope of the plane along y
SensorSample sample_of_plane(double height, double noise, double rise = 0) {
  SensorSample sample = sample_of(every_period_but({}));
  const Eigen::Isometry3d pose = nominal_platform_from_sensor();
  const Intrinsics& lens = sample.intrinsics;
  for (int i = 0; i < 4; ++i) {
    DepthFrame frame{.width = lens.width, .height = lens.height};
    for (int v = 0; v < lens.height; ++v) {
      for (int u = 0; u < lens.width; ++u) {
        const Eigen::Vector3d direction =
            pose.linear() * Eigen::Vector3d((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
        const double to_plane = height + rise * pose.translation().y() - pose.translation().z();
        const double depth =
            to_plane / (direction.z() - rise * direction.y()) + (i % 2 == 0 ? noise : -noise);
        const bool is_seen = direction.z() < 0 && depth < 6;
        frame.depth.push_back(
            is_seen ? static_cast<std::uint16_t>(std::lround(depth / lens.depth_unit)) : 0);
      }
    }
    sample.frames.push_back(std::move(frame));
  }
  return sample;
}

PlatformView view_of_plane(double height, double noise = 0) {
  return measure_platform(sample_of_plane(height, noise), clip, nominal_platform_from_sensor());
}

TEST(FrameRateCheck, MeasuresIt) {
  const Finding finding = check_frame_rate(sample_of(every_period_but({})));
  EXPECT_EQ(finding.state, State::ok);
  EXPECT_EQ(finding.measured, "30.0 frames a second");
}

TEST(FrameRateCheck, WarnsOfASlowSensor) {
  std::vector<Time> times;
  for (int i = 0; i < 30; ++i) {
    times.push_back(Time(1s) + i * 100ms);
  }
  const Finding finding = check_frame_rate(sample_of(times));
  EXPECT_EQ(finding.state, State::warning);
  EXPECT_EQ(finding.measured, "10.0 frames a second");
}

TEST(LostFramesCheck, CountsTheGaps) {
  EXPECT_EQ(check_lost_frames(sample_of(every_period_but({}))).measured, "0 of 60");
  EXPECT_EQ(check_lost_frames(sample_of(every_period_but({20}))).state, State::ok);
  const Finding busy = check_lost_frames(sample_of(every_period_but({20, 30, 31})));
  EXPECT_EQ(busy.measured, "3 of 60");
  EXPECT_EQ(busy.state, State::warning);
  EXPECT_NE(busy.advice.find("too busy"), std::string::npos);
}

/// Counts of frames, each with 1000 packets.
PacketCounts counts_of(int whole, int partial, int dropped, int lost_packets) {
  return {.whole_frames = whole,
          .partial_frames = partial,
          .dropped_frames = dropped,
          .packets = 1000 * (whole + partial + dropped),
          .lost_packets = lost_packets};
}

TEST(LostFramesCheck, TellsALossyWireFromABusyMachine) {
  const Finding some =
      check_lost_frames(sample_of(every_period_but({20, 30, 31}), counts_of(57, 0, 3, 900)));
  EXPECT_EQ(some.measured, "57 of 60 whole, 0 in part, 3 lost; 1.5 % of the packets lost");
  EXPECT_EQ(some.state, State::warning);
  EXPECT_NE(some.advice.find("cable"), std::string::npos);
  const Finding most =
      check_lost_frames(sample_of(every_period_but({}), counts_of(60, 0, 61, 50000)));
  EXPECT_EQ(most.state, State::fault);
}

TEST(LostFramesCheck, WarnsOfManyLostPackets) {
  const auto check = [](int lost_packets) {
    return check_lost_frames(sample_of(every_period_but({}), counts_of(40, 20, 0, lost_packets)));
  };
  EXPECT_EQ(check(300).state, State::ok);
  EXPECT_EQ(check(300).measured, "40 of 60 whole, 20 in part, 0 lost; 0.5 % of the packets lost");
  EXPECT_EQ(check(1200).state, State::warning);
}

TEST(LostFramesCheck, TellsOthersReportsAsReportsWhereTheyBelong) {
  const auto advice_on = [](const char* board) {
    return check_lost_frames(sample_of(every_period_but({}), counts_of(0, 60, 0, 3000)), board)
        .advice;
  };
  EXPECT_NE(advice_on("Raspberry Pi 4 Model B Rev 1.4").find("Others report, without proof"),
            std::string::npos);
  EXPECT_NE(advice_on("Raspberry Pi 4 Model B Rev 1.4").find("pcie_aspm=off"), std::string::npos);
  EXPECT_NE(advice_on("Raspberry Pi 3 Model B Rev 1.2").find("Others report"), std::string::npos);
  EXPECT_EQ(advice_on("Raspberry Pi 3 Model B Rev 1.2").find("pcie"), std::string::npos);
  EXPECT_EQ(advice_on("").find("report"), std::string::npos);
}

TEST(PlatformCheck, FindsThePlatformWhereTheCalibrationHasIt) {
  const PlatformView view = view_of_plane(0);
  EXPECT_EQ(view.readings, view.rays);
  EXPECT_EQ(view.on_surface, view.rays);
  ASSERT_TRUE(view.surface);
  EXPECT_NEAR(view.surface->height, 0, 0.00001);  // a tenth of the sensor's unit: a mean of many
  const Finding finding = check_platform(view);
  EXPECT_EQ(finding.state, State::ok);
  EXPECT_EQ(finding.measured,
            "0.0 mm above where the calibration has it and level, 100 % of it has readings");
}

// The projected area of a circle of 28 cm about the axis, seen from 0.72 m and 30 degrees above.
TEST(PlatformCheck, LooksAtTheCircleInsideTheClipBox) {
  const double f = Intrinsics{}.fx;
  const double distance = std::hypot(0.62, 0.36);
  const double area =
      std::numbers::pi * 0.14 * 0.14 * (0.36 / distance) * f * f / (distance * distance);
  // The formula is for a circle that is small compared to its distance; this one is not.
  EXPECT_NEAR(view_of_plane(0).rays, area, 0.1 * area);
}

TEST(PlatformCheck, WarnsOfAPlatformThatIsTooHigh) {
  const PlatformView view = view_of_plane(0.006);
  const Finding finding = check_platform(view);
  EXPECT_EQ(finding.state, State::warning);
  EXPECT_EQ(finding.measured,
            "6.0 mm above where the calibration has it and level, 100 % of it has readings");
  EXPECT_EQ(finding.action, Action::measure_turn);
  EXPECT_EQ(check_platform(view_of_plane(-0.006)).measured.substr(0, 12), "6.0 mm below");
}

// The platform's centre has the right height, so the median height alone would not show the tilt.
TEST(PlatformCheck, WarnsOfAPlatformThatIsTilted) {
  const double rise = std::tan(radians_from_degrees(2));
  const PlatformView view =
      measure_platform(sample_of_plane(0, 0, rise), clip, nominal_platform_from_sensor());
  ASSERT_TRUE(view.surface);
  EXPECT_NEAR(view.surface->slope.y(), rise, 0.0002);  // 0.01 degrees
  EXPECT_NEAR(view.surface->slope.x(), 0, 0.0002);
  const Finding finding = check_platform(view);
  EXPECT_EQ(finding.state, State::warning);
  EXPECT_NE(finding.measured.find("tilted by 2.0 degrees, the far side up"), std::string::npos)
      << finding.measured;
  EXPECT_EQ(finding.action, Action::measure_turn);
}

TEST(PlatformCheck, HasItSetByHandWhereATurnWouldNotFindIt) {
  const Finding high = check_platform(view_of_plane(0.05));
  EXPECT_EQ(high.state, State::fault);
  EXPECT_EQ(high.measured.substr(0, 13), "50.0 mm above");
  EXPECT_EQ(high.action, Action::set_pose);
}

TEST(PlatformCheck, FindsThatItIsSomewhereElse) {
  const Finding finding = check_platform(view_of_plane(-0.1));
  EXPECT_EQ(finding.state, State::fault);
  EXPECT_EQ(finding.measured, "nothing is where the calibration has it");
  EXPECT_EQ(finding.action, Action::set_pose);
}

TEST(PlatformCheck, FindsThatHalfOfItIsNotSeen) {
  SensorSample sample = sample_of_plane(0, 0);
  for (DepthFrame& frame : sample.frames) {
    for (std::size_t row = 0; row < frame.depth.size(); row += 640) {  // a little more than half
      std::fill_n(frame.depth.begin() + static_cast<std::ptrdiff_t>(row), 330, std::uint16_t{0});
    }
  }
  const PlatformView half = measure_platform(sample, clip, nominal_platform_from_sensor());
  EXPECT_EQ(check_platform(half).state, State::warning);
  for (DepthFrame& frame : sample.frames) {
    std::ranges::fill(frame.depth, std::uint16_t{0});
  }
  const PlatformView none = measure_platform(sample, clip, nominal_platform_from_sensor());
  EXPECT_EQ(none.readings, 0);
  EXPECT_EQ(check_platform(none).state, State::fault);
  EXPECT_EQ(check_depth_noise(none).state, State::unknown);
}

TEST(PlatformCheck, FindsThatTheCalibrationLooksElsewhere) {
  Eigen::Isometry3d away = nominal_platform_from_sensor();
  away.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()));
  const PlatformView view = measure_platform(sample_of_plane(0, 0), clip, away);
  EXPECT_EQ(view.rays, 0);
  EXPECT_EQ(check_platform(view).state, State::fault);
}

TEST(DepthNoiseCheck, MeasuresHowFarReadingsAreFromTheirMean) {
  const PlatformView view = view_of_plane(0, 0.0015);
  EXPECT_NEAR(view.noise, 0.0015, 0.0001);  // the sensor's unit
  EXPECT_EQ(check_depth_noise(view).state, State::ok);
  EXPECT_EQ(check_depth_noise(view).measured.substr(0, 4), "1.50");
}

TEST(DepthNoiseCheck, FindsANoisySensor) {
  EXPECT_EQ(check_depth_noise(view_of_plane(0, 0.004)).state, State::warning);
  EXPECT_EQ(check_depth_noise(view_of_plane(0, 0.012)).state, State::fault);
}

Tilt tilt_of(double pitch_deg, double roll_deg) {
  return {.pitch = radians_from_degrees(pitch_deg), .roll = radians_from_degrees(roll_deg)};
}

TEST(TiltCheck, ComparesItWithTheCalibration) {
  const Eigen::Isometry3d pose = nominal_platform_from_sensor();  // pitched down by 25 degrees
  EXPECT_EQ(check_tilt(tilt_of(-25, 0), pose).state, State::ok);
  EXPECT_EQ(check_tilt(tilt_of(-27, 0), pose).state, State::warning);
  EXPECT_EQ(check_tilt(tilt_of(-25, 2), pose).state, State::warning);
  const Finding level = check_tilt(tilt_of(0, 0), pose);
  EXPECT_EQ(level.state, State::fault);
  EXPECT_EQ(level.measured, "pitch 0.0°, roll 0.0°; calibrated at -25.0°, 0.0°");
  EXPECT_EQ(check_tilt(std::nullopt, pose).state, State::unknown);
}

// A sensor rolled about its optical axis from right to down has its right side lower.
TEST(TiltCheck, KnowsWhichSideIsTheLower) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  pose.rotate(Eigen::AngleAxisd(radians_from_degrees(10), Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(check_tilt(tilt_of(0, 10), pose).state, State::ok);
  EXPECT_EQ(check_tilt(tilt_of(0, -10), pose).state, State::fault);
}

TEST(SensorChecks, AreFaultAndUnknownWithoutASensor) {
  const SensorReading silent = Failure{.code = ErrorCode::sensor_silent,
                                       .detail = "sensor: no frame for 2000 ms",
                                       .hint = "Unplug the sensor."};
  const auto findings = check_sensor(silent, clip, nominal_platform_from_sensor());
  ASSERT_EQ(findings.size(), 6);
  EXPECT_EQ(findings[0].state, State::fault);
  EXPECT_EQ(findings[0].measured, "sensor: no frame for 2000 ms");
  EXPECT_EQ(findings[0].advice, "Unplug the sensor.");
  EXPECT_EQ(std::ranges::count(findings, State::unknown, &Finding::state), 5);
}

TEST(SensorChecks, AreNoFaultWhileTheSensorIsBusy) {
  const SensorReading busy =
      Failure{.code = ErrorCode::busy, .detail = "a scan is running", .hint = "Check again later."};
  const auto findings = check_sensor(busy, clip, nominal_platform_from_sensor());
  EXPECT_EQ(std::ranges::count(findings, State::unknown, &Finding::state), 6);
  EXPECT_EQ(findings[0].measured, "a scan is running");
}

TEST(SensorChecks, AreTheSameChecksWithASensorAndWithout) {
  const auto without = check_sensor(Failure{}, clip, nominal_platform_from_sensor());
  const auto with = check_sensor(sample_of_plane(0, 0), clip, nominal_platform_from_sensor());
  EXPECT_TRUE(std::ranges::equal(with, without, {}, &Finding::check, &Finding::check));
  EXPECT_EQ(with[0].measured, "Kinect v1, 640 x 480");
}

}  // namespace
}  // namespace octurn
