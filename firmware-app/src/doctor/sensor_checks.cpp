#include "doctor/sensor_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr Check sensor_check{"sensor", "Sensor"};
constexpr Check frame_rate{"frame-rate", "Frame rate"};
constexpr Check lost_frames{"lost-frames", "Lost frames"};
constexpr Check tilt_check{"tilt", "Tilt of the sensor"};

constexpr const char* measure_it = "Measure where the sensor stands with a turn of any object.";
constexpr const char* turn_it_back =
    "Turn the sensor back to where it stood, or set its pose until the ring in the picture lies on "
    "the platform.";

// Every supported sensor delivers 30 Hz in the mode that Octurn chooses.
constexpr double nominal_rate_hz = 30;
constexpr double low_rate_hz = 27;

// One degree moves a point at 0.7 m by 12 mm.
constexpr double small_turn = radians_from_degrees(1.5);
constexpr double large_turn = radians_from_degrees(5);

// Ten frames of a stop have every pixel at ten times as much; but a wire that is well loses
// nothing.
constexpr double large_lost_share = 0.01;

/// The hints for single boards are from other people's reports (libfreenect, issue 639): nobody
/// knows why they helped.
std::string advice_on_losses(std::string_view board) {
  constexpr const char* anywhere =
      "Plug the sensor directly into another USB port, and check its power supply and cable.";
  if (board.starts_with("Raspberry Pi 4")) {
    return std::string(anywhere) +
           " Others report, without proof, that it helped on a Raspberry Pi 4 to plug any other "
           "USB "
           "device into a free port, to use a powered hub, or to start Linux with pcie_aspm=off.";
  }
  if (board.starts_with("Raspberry Pi 3")) {
    return std::string(anywhere) +
           " Others report, without proof, that it helped on a Raspberry Pi to plug any other USB "
           "device into a free port, or to use a powered hub.";
  }
  return anywhere;
}

double seconds_between(const SensorSample& sample, std::size_t from, std::size_t to) {
  return std::chrono::duration<double>(sample.times[to] - sample.times[from]).count();
}

}  // namespace

Finding check_frame_rate(const SensorSample& sample) {
  const double seconds = seconds_between(sample, 0, sample.times.size() - 1);
  const double rate = seconds > 0 ? static_cast<double>(sample.times.size() - 1) / seconds : 0;
  const std::string measured = rounded(rate, 1) + " frames a second";
  return rate < low_rate_hz
             ? frame_rate.warning(measured,
                                  "End other programs on this machine, and give the sensor a USB "
                                  "port without a hub.")
             : frame_rate.ok(measured);
}

Finding check_lost_frames(const SensorSample& sample, std::string_view board) {
  int missing = 0;
  for (std::size_t i = 1; i < sample.times.size(); ++i) {
    const double periods = seconds_between(sample, i - 1, i) * nominal_rate_hz;
    missing += std::max(0, static_cast<int>(std::lround(periods)) - 1);
  }
  const PacketCounts packets = sample.packets.value_or(PacketCounts());
  const auto dropped = static_cast<int>(packets.dropped_frames);
  const int lost = std::max(missing, dropped);
  const int all = static_cast<int>(sample.times.size()) + lost;
  const auto partial = static_cast<int>(packets.partial_frames);
  const std::string measured =
      sample.packets
          ? std::to_string(std::max(all - lost - partial, 0)) + " of " + std::to_string(all) +
                " whole, " + std::to_string(partial) + " in part, " + std::to_string(lost) +
                " lost; " + rounded(100 * packets.lost_share(), 1) + " % of the packets lost"
          : std::to_string(lost) + " of " + std::to_string(all);
  const auto is_many = [&](int frames) { return 50 * frames > all; };
  if (2 * dropped > all) {
    return lost_frames.fault(measured, advice_on_losses(board));
  }
  if (is_many(dropped) || packets.lost_share() > large_lost_share) {
    return lost_frames.warning(measured, advice_on_losses(board));
  }
  return is_many(lost)
             ? lost_frames.warning(
                   measured, "End other programs: this machine was too busy to take every frame.")
             : lost_frames.ok(measured);
}

Finding check_tilt(const std::optional<Tilt>& tilt, const Eigen::Isometry3d& platform_from_sensor) {
  if (!tilt) {
    return tilt_check.unknown("this sensor does not report its tilt");
  }
  const Eigen::Matrix3d& axes = platform_from_sensor.linear();
  const Eigen::Vector3d right = axes.col(0);
  const Eigen::Vector3d up = -axes.col(1);
  const Eigen::Vector3d forward = axes.col(2);
  const double pitch = std::atan2(forward.z(), forward.head<2>().norm());
  const double roll = std::atan2(-right.z(), up.z());
  const double off = std::max(std::abs(tilt->pitch - pitch), std::abs(tilt->roll - roll));
  const auto degrees = [](double angle) { return rounded(degrees_from_radians(angle), 1) + "°"; };
  const std::string measured = "pitch " + degrees(tilt->pitch) + ", roll " + degrees(tilt->roll) +
                               "; calibrated at " + degrees(pitch) + ", " + degrees(roll);
  return off > large_turn   ? tilt_check.fault(measured, turn_it_back, Action::set_pose)
         : off > small_turn ? tilt_check.warning(measured, measure_it, Action::measure_turn)
                            : tilt_check.ok(measured);
}

std::vector<Finding> check_sensor(const SensorReading& reading, const Box& clip,
                                  const Eigen::Isometry3d& platform_from_sensor,
                                  std::string_view board) {
  if (const auto* failure = std::get_if<Failure>(&reading)) {
    const bool busy = failure->code == ErrorCode::busy;
    std::vector<Finding> findings{busy ? sensor_check.unknown(failure->detail, failure->hint)
                                       : sensor_check.fault(failure->detail, failure->hint)};
    for (const Check& check :
         {frame_rate, lost_frames, platform_check, depth_noise_check, tilt_check}) {
      findings.push_back(check.unknown(busy ? "not measured" : "no sensor to measure"));
    }
    return findings;
  }
  if (const auto* camera = std::get_if<CameraSample>(&reading)) {
    std::string seen = camera->name + ", " + std::to_string(camera->width) + " x " +
                       std::to_string(camera->height) + ", sees laser";
    for (const std::string& laser : camera->lasers) {
      seen += (laser == camera->lasers.front() ? " " : " and ") + laser;
    }
    return {sensor_check.ok(seen)};
  }
  const auto& sample = std::get<SensorSample>(reading);
  const PlatformView view = measure_platform(sample, clip, platform_from_sensor);
  return {sensor_check.ok(sample.name + ", " + std::to_string(sample.intrinsics.width) + " x " +
                          std::to_string(sample.intrinsics.height)),
          check_frame_rate(sample),
          check_lost_frames(sample, board),
          check_platform(view),
          check_depth_noise(view),
          check_tilt(sample.tilt, platform_from_sensor)};
}

}  // namespace octurn
