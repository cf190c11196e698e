#include "doctor/sensor_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "octurn/units.hpp"

namespace octurn {
namespace {

constexpr Check sensor{"sensor", "Sensor"};
constexpr Check frame_rate{"frame-rate", "Frame rate"};
constexpr Check lost_frames{"lost-frames", "Lost frames"};
constexpr Check platform{"platform", "Platform"};
constexpr Check depth_noise{"depth-noise", "Depth noise"};
constexpr Check tilt_check{"tilt", "Tilt of the sensor"};

constexpr const char* stand_it_right =
    "Set the sensor up as docs/wiring.md says, or correct platform_from_sensor in octurn.json.";

// Every supported sensor delivers 30 Hz in the mode that Octurn chooses.
constexpr double nominal_rate_hz = 30;
constexpr double low_rate_hz = 27;

constexpr int few_rays = 500;  // a platform of 28 cm, 2 m away, has ten times as many

// With its noise, a platform this high reaches into a clip box that begins at 5 mm.
constexpr double much_too_high = 0.004;

// Steps of a Kinect's depth are 1 mm at 0.6 m and 3 mm at 1 m (reference: 345489 / (1089.4 - raw)),
// and its noise is less than a step.
constexpr double much_noise = 0.003;
constexpr double too_much_noise = 0.01;

// One degree moves a point at 0.7 m by 12 mm.
constexpr double small_turn = radians_from_degrees(1.5);
constexpr double large_turn = radians_from_degrees(5);

std::string mm(double metres, int digits) {
  return rounded(mm_from_metres(metres), digits) + " mm";
}

std::string percent(int part, int whole) {
  return std::to_string(whole == 0 ? 0 : 100 * part / whole) + " %";
}

double seconds_between(const SensorSample& sample, std::size_t from, std::size_t to) {
  return std::chrono::duration<double>(sample.times[to] - sample.times[from]).count();
}

/// The value that `share` of the others lie below. @param values  at least one; put in another
/// order
double quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<std::size_t>(at)];
}

/// A pixel's ray in the platform frame: `direction` is the way of one metre of depth.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;

  Eigen::Vector3d at(double depth) const { return origin + depth * direction; }
  double depth_of_surface() const { return -origin.z() / direction.z(); }
};

Ray make_ray(int u, int v, const Intrinsics& lens, const Eigen::Isometry3d& platform_from_sensor) {
  const Eigen::Vector3d in_sensor((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
  return {.origin = platform_from_sensor.translation(),
          .direction = platform_from_sensor.linear() * in_sensor};
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

/// Heights of pixels on the surface, and deviations of their depths from each pixel's mean.
struct Surface {
  std::vector<double> heights = {};
  std::vector<double> deviations = {};

  void add(const std::vector<double>& depths, double mean_depth, double height) {
    heights.push_back(height);
    for (const double depth : depths) {
      deviations.push_back(std::abs(depth - mean_depth));
    }
  }
};

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

Finding check_lost_frames(const SensorSample& sample) {
  int missing = 0;
  for (std::size_t i = 1; i < sample.times.size(); ++i) {
    const double periods = seconds_between(sample, i - 1, i) * nominal_rate_hz;
    missing += std::max(0, static_cast<int>(std::lround(periods)) - 1);
  }
  const int damaged = sample.damaged.value_or(0);
  const int lost = std::max(missing, damaged);
  const int all = static_cast<int>(sample.times.size()) + lost;
  const std::string measured =
      std::to_string(lost) + " of " + std::to_string(all) +
      (sample.damaged ? ", " + std::to_string(damaged) + " of them damaged on the way" : "");
  const auto is_many = [&](int frames) { return 50 * frames > all; };
  if (is_many(damaged)) {
    constexpr const char* advice =
        "Plug the sensor directly into another USB port, and check its power supply and cable.";
    return 2 * damaged > all ? lost_frames.fault(measured, advice)
                             : lost_frames.warning(measured, advice);
  }
  return is_many(lost)
             ? lost_frames.warning(
                   measured, "End other programs: this machine was too busy to take every frame.")
             : lost_frames.ok(measured);
}

PlatformView measure_platform(const SensorSample& sample, const Box& clip,
                              const Eigen::Isometry3d& platform_from_sensor) {
  PlatformView view;
  Surface surface;
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
        surface.add(depths, depth, height);
      }
    }
  }
  if (view.on_surface > 0) {
    view.height = quantile(surface.heights, 0.5);
    view.noise = quantile(surface.deviations, 0.683);  // that part of a normal distribution is
                                                       // within its standard deviation
  }
  return view;
}

Finding check_platform(const PlatformView& view) {
  if (view.rays < few_rays) {
    return platform.fault("not in the picture, by the calibration", stand_it_right);
  }
  const std::string seen = percent(view.readings, view.rays) + " of it has readings";
  if (10 * view.readings < view.rays) {
    return platform.fault(seen,
                          "See that nothing stands before the sensor, that it is 0.5 to 1 m away, "
                          "and that no sun shines on the platform.");
  }
  if (10 * view.on_surface < view.readings) {
    return platform.fault("nothing is where the calibration has it", stand_it_right);
  }
  const std::string measured = mm(std::abs(view.height), 1) +
                               (view.height < 0 ? " below" : " above") +
                               " where the calibration has it, " + seen;
  if (std::abs(view.height) > much_too_high) {
    return platform.warning(measured, stand_it_right);
  }
  return 2 * view.readings < view.rays
             ? platform.warning(measured,
                                "Take large objects off, and cover a black or shiny platform with "
                                "matt paper.")
             : platform.ok(measured);
}

Finding check_depth_noise(const PlatformView& view) {
  if (view.on_surface < few_rays) {
    return depth_noise.unknown("too little of the platform is seen");
  }
  const std::string measured = mm(view.noise, 2) + " on the platform";
  constexpr const char* advice =
      "Keep sunlight and other depth cameras away, and let the sensor stand still and warm up.";
  return view.noise > too_much_noise ? depth_noise.fault(measured, advice)
         : view.noise > much_noise   ? depth_noise.warning(measured, advice)
                                     : depth_noise.ok(measured);
}

Finding check_tilt(const std::optional<Tilt>& tilt, const Eigen::Isometry3d& platform_from_sensor) {
  if (!tilt) {
    return tilt_check.unknown("this sensor does not tell it");
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
  return off > large_turn   ? tilt_check.fault(measured, stand_it_right)
         : off > small_turn ? tilt_check.warning(measured, stand_it_right)
                            : tilt_check.ok(measured);
}

std::vector<Finding> check_sensor(const SensorReading& reading, const Box& clip,
                                  const Eigen::Isometry3d& platform_from_sensor) {
  if (const auto* failure = std::get_if<Failure>(&reading)) {
    const bool busy = failure->code == ErrorCode::busy;
    std::vector<Finding> findings{busy ? sensor.unknown(failure->detail, failure->hint)
                                       : sensor.fault(failure->detail, failure->hint)};
    for (const Check& check : {frame_rate, lost_frames, platform, depth_noise, tilt_check}) {
      findings.push_back(check.unknown(busy ? "not measured" : "no sensor to measure"));
    }
    return findings;
  }
  const auto& sample = std::get<SensorSample>(reading);
  const PlatformView view = measure_platform(sample, clip, platform_from_sensor);
  return {sensor.ok(sample.name + ", " + std::to_string(sample.intrinsics.width) + " x " +
                    std::to_string(sample.intrinsics.height)),
          check_frame_rate(sample),
          check_lost_frames(sample),
          check_platform(view),
          check_depth_noise(view),
          check_tilt(sample.tilt, platform_from_sensor)};
}

}  // namespace octurn
