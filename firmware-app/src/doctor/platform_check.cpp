#include "doctor/platform_check.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "octurn/units.hpp"
#include "sensor/pixel_ray.hpp"

namespace octurn {
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

}  // namespace octurn
