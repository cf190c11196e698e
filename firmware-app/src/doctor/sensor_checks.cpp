#include "doctor/sensor_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "capture/take_pictures.hpp"
#include "octurn/units.hpp"
#include "sensor/pixel_ray.hpp"

namespace octurn {
namespace {

constexpr int first_frames = 10;  // skipped: a sensor that was just opened is still irregular
constexpr int timed_frames = 60;  // two seconds
constexpr std::size_t kept_frames = 10;  // as a scan takes at each stop

/// @return nothing if `stop` is requested first
std::optional<SensorSample> sample(DepthSensor& sensor, const std::stop_token& stop) {
  SensorSample sample{
      .name = sensor.name(), .serial = sensor.serial(), .intrinsics = sensor.intrinsics()};
  std::optional<PacketCounts> before;
  for (int count = 0; count < first_frames + timed_frames; ++count) {
    std::optional<TimedFrame> timed = sensor.read(stop);
    if (!timed) {
      return std::nullopt;
    }
    if (count < first_frames) {
      before = sensor.packet_counts();
      continue;
    }
    sample.times.push_back(timed->time);
    if (first_frames + timed_frames - count <= static_cast<int>(kept_frames)) {
      sample.frames.push_back(std::move(timed->frame));
    }
  }
  if (const auto after = sensor.packet_counts(); after && before) {
    sample.packets = *after - *before;
  }
  sample.tilt = sensor.tilt();
  return sample;
}

/// @return nothing if `stop` is requested first
/// @throws Error  with the fault of the camera, the room's light or a laser
std::optional<CameraSample> sample_camera(Rig& rig, const std::stop_token& stop) {
  const auto taken = take_pictures_here(rig, stop, {});
  if (!taken) {
    return std::nullopt;
  }
  CameraSample sample{.name = rig.camera().name(),
                      .width = taken->pictures.front().width,
                      .height = taken->pictures.front().height};
  for (const Laser& laser : laser_camera(*rig.laser()).lasers) {
    sample.lasers.push_back(laser.name);
  }
  return sample;
}

}  // namespace

SensorReading read_sensor(Rig& rig, const std::stop_token& stop) {
  try {
    if (rig.laser() != nullptr) {
      if (auto seen = sample_camera(rig, stop)) {
        return *std::move(seen);
      }
    } else if (auto seen = sample(rig.sensor(), stop)) {
      return *std::move(seen);
    }
    return Failure{.code = ErrorCode::busy,
                   .detail = "not checked: something else began to use the sensor",
                   .hint = "Check again later."};
  } catch (const Error& error) {
    rig.close_sensor();
    return to_failure(error);
  }
}

namespace {

constexpr const char* place_it =
    "Set the sensor up as docs/wiring.md says, or set its pose until the ring in the picture lies "
    "on the platform.";

constexpr int few_rays = 500;  // a platform of 28 cm, 2 m away, has ten times as many

// Limits of a warning. With its noise, a platform that is this much too high reaches into a clip
// box that begins at 5 mm. So does the rim, 14 cm from the axis, of one that is tilted this much.
constexpr double much_too_high = 0.004;
constexpr double much_tilted = radians_from_degrees(1.5);

// Limits of a fault: a calibration turn measures up to 40 mm and 6 degrees.
constexpr double too_high = 0.035;
constexpr double too_tilted = radians_from_degrees(5);

// Steps of a Kinect's depth are 1 mm at 0.6 m and 3 mm at 1 m (reference: 345489 / (1089.4 - raw)),
// and its noise is less than a step.
constexpr double much_noise = 0.003;
constexpr double too_much_noise = 0.01;

std::string mm(double metres, int digits = 1) {
  return rounded(mm_from_metres(metres), digits) + " mm";
}

std::string percent(int part, int whole) {
  return std::to_string(whole == 0 ? 0 : 100 * part / whole) + " %";
}

/// The quantile of values at a share from 0 to 1. @param values  at least one; reordered
double quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

/// A pixel's ray in the platform frame; `direction` is its displacement for a metre of depth.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;

  Eigen::Vector3d at(double depth) const { return origin + depth * direction; }
  double depth_of_surface() const { return -origin.z() / direction.z(); }
};

Ray make_ray(int u, int v, const Intrinsics& lens, const Eigen::Isometry3d& platform_from_sensor) {
  return {.origin = platform_from_sensor.translation(),
          .direction = platform_from_sensor.linear() * pixel_ray(lens, u, v)};
}

/// Radius of the largest circle about the platform's axis inside the box.
double radius_within(const Box& clip) {
  return std::min(std::min(-clip.min.x(), clip.max.x()), std::min(-clip.min.y(), clip.max.y()));
}

bool meets_platform(const Ray& ray, double radius) {
  return ray.direction.z() < 0 && ray.at(ray.depth_of_surface()).head<2>().norm() <= radius;
}

/// Depths of one pixel in all frames, metres, without missing readings.
std::vector<double> readings_at(const SensorSample& sample, std::size_t pixel) {
  std::vector<double> depths;
  for (const DepthFrame& frame : sample.frames) {
    if (frame.depth[pixel] != 0) {
      depths.push_back(frame.depth[pixel] * sample.intrinsics.depth_unit);
    }
  }
  return depths;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

/// Adds the absolute deviation of each depth from the mean.
void add_deviations(std::vector<double>& deviations, const std::vector<double>& depths,
                    double mean_depth) {
  for (const double depth : depths) {
    deviations.push_back(std::abs(depth - mean_depth));
  }
}

/// The higher side of the platform, as seen from behind the sensor.
std::string higher_side(const Eigen::Vector2d& slope) {
  if (std::abs(slope.x()) > std::abs(slope.y())) {
    return slope.x() > 0 ? "right" : "left";
  }
  return slope.y() > 0 ? "far" : "near";
}

/// Describes height and tilt: "2.3 mm above where the calibration has it and tilted by 0.8 degrees,
/// the far side up".
std::string place_text(const PlatformSurface& surface) {
  const std::string height = mm(std::abs(surface.height)) +
                             (surface.height < 0 ? " below" : " above") +
                             " where the calibration has it";
  const std::string tilt = rounded(degrees_from_radians(surface.tilt), 1);
  return tilt == "0.0" ? height + " and level"
                       : height + " and tilted by " + tilt + " degrees, the " +
                             higher_side(surface.slope) + " side up";
}

}  // namespace

PlatformView measure_platform(const SensorSample& sample, const Box& clip,
                              const Eigen::Isometry3d& platform_from_sensor) {
  PlatformView view;
  std::vector<double> deviations;
  const Intrinsics& lens = sample.intrinsics;
  const double radius = radius_within(clip);
  std::size_t pixel = 0;
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u, ++pixel) {
      const Ray ray = make_ray(u, v, lens, platform_from_sensor);
      if (!meets_platform(ray, radius)) {
        continue;
      }
      ++view.rays;
      const std::vector<double> depths = readings_at(sample, pixel);
      if (depths.empty() || 2 * depths.size() < sample.frames.size()) {
        continue;
      }
      ++view.readings;
      const double depth = mean(depths);
      const double height = ray.at(depth).z();
      if (std::abs(height) <= surface_tolerance) {
        ++view.on_surface;
        add_deviations(deviations, depths, depth);
      }
    }
  }
  if (!deviations.empty()) {
    // 68.3 % of a normal distribution lie within one standard deviation of the mean.
    view.noise = quantile(deviations, 0.683);
  }
  if (!sample.frames.empty()) {
    view.surface = measure_platform_surface(merge_frames(sample.frames, DepthFilter::average), lens,
                                            platform_from_sensor);
  }
  return view;
}

Finding check_platform(const PlatformView& view) {
  if (view.rays < few_rays) {
    return platform_check.fault("not in the picture, by the calibration", place_it,
                                Action::set_pose);
  }
  const std::string seen = percent(view.readings, view.rays) + " of it has readings";
  if (10 * view.readings < view.rays) {
    return platform_check.fault(
        seen,
        "See that nothing stands before the sensor, that it is 0.5 to 1 m away, "
        "and that no sun shines on the platform.");
  }
  if (!view.surface) {
    return platform_check.fault("nothing is where the calibration has it", place_it,
                                Action::set_pose);
  }
  const std::string measured = place_text(*view.surface) + ", " + seen;
  if (std::abs(view.surface->height) > too_high || view.surface->tilt > too_tilted) {
    return platform_check.fault(measured, place_it, Action::set_pose);
  }
  if (std::abs(view.surface->height) > much_too_high || view.surface->tilt > much_tilted) {
    return platform_check.warning(
        measured, "Measure it with a turn of any object, which finds height and tilt.",
        Action::measure_turn);
  }
  return 2 * view.readings < view.rays
             ? platform_check.warning(
                   measured,
                   "Take large objects off, and cover a black or shiny platform with "
                   "matt paper.")
             : platform_check.ok(measured);
}

Finding check_depth_noise(const PlatformView& view) {
  if (view.on_surface < few_rays) {
    return depth_noise_check.unknown("too little of the platform is seen");
  }
  const std::string measured = mm(view.noise, 2) + " on the platform";
  constexpr const char* advice =
      "Keep sunlight and other depth cameras away, and let the sensor stand still and warm up.";
  return view.noise > too_much_noise ? depth_noise_check.fault(measured, advice)
         : view.noise > much_noise   ? depth_noise_check.warning(measured, advice)
                                     : depth_noise_check.ok(measured);
}

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
    // In quotes, as a translation keeps it.
    std::string seen = "\"" + camera->name + "\", " + std::to_string(camera->width) + " x " +
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
