#include "calibrate/read_turn.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/for_each_stop.hpp"
#include "calibrate/object_view.hpp"
#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"

namespace octurn {
namespace {

constexpr std::size_t plane_stops = 6;    // tell the plane well enough to find the object
constexpr int platform_step = 4;          // pixels between readings that the plane is fitted to
constexpr double readings_wanted = 300;   // of the object at a stop: more cost time and tell little
constexpr int max_step = 6;               // pixels
constexpr double correlated_pixels = 50;  // the sensor's errors are alike in some 7 x 7 pixels
constexpr double uses = 8;                // comparisons that share a reading and its error

/// A coarse grid of pixels.
PlatformSamples make_samples(const Intrinsics& lens, std::size_t stops) {
  PlatformSamples samples{
      .columns = static_cast<std::size_t>((lens.width + platform_step - 1) / platform_step),
      .rays = {},
      .depths = std::vector<std::vector<float>>(stops)};
  for (int v = 0; v < lens.height; v += platform_step) {
    for (int u = 0; u < lens.width; u += platform_step) {
      samples.rays.push_back(to_ray(lens, u, v));
    }
  }
  return samples;
}

/// Stops all around the turn.
std::vector<std::size_t> spread_stops(std::size_t stops) {
  const std::size_t count = std::min(plane_stops, stops);
  std::vector<std::size_t> spread;
  for (std::size_t i = 0; i < count; ++i) {
    spread.push_back(i * stops / count);
  }
  return spread;
}

}  // namespace

TurnReader::TurnReader(const CalibrationTurn& turn, int threads)
    : turn_(turn),
      threads_(threads),
      samples_(make_samples(turn.intrinsics, turn.angles.size())),
      kept_(turn.angles.size()) {}

void TurnReader::sample(std::size_t stop, const DepthFrame& frame) {
  check_size(frame, turn_.intrinsics, "calibrate");
  std::vector<float>& depths = samples_.depths[stop];
  depths.reserve(samples_.rays.size());
  for (int v = 0; v < frame.height; v += platform_step) {
    for (int u = 0; u < frame.width; u += platform_step) {
      const auto z = static_cast<float>(
          frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                      static_cast<std::size_t>(u)] *
          turn_.intrinsics.depth_unit);
      depths.push_back(static_cast<double>(z) > nearest_z ? z : 0.0F);
    }
  }
}

const std::optional<PlatformPlane>& TurnReader::find_platform() {
  const std::vector<std::size_t> stops = spread_stops(turn_.angles.size());
  for_each_stop(stops.size(), threads_, [&](std::size_t i) {
    const std::size_t stop = stops[i];
    kept_[stop] = turn_.read(stop);
    sample(stop, *kept_[stop]);
  });
  PlatformSamples few{.columns = samples_.columns, .rays = samples_.rays, .depths = {}};
  for (const std::size_t stop : stops) {
    few.depths.push_back(samples_.depths[stop]);
  }
  plane_ = fit_platform_plane(few, turn_.platform_from_sensor);
  return plane_;
}

TurnViews TurnReader::read_views() {
  const Eigen::Isometry3d levelled = level(turn_.platform_from_sensor, *plane_);
  const ObjectView::Mask mask{.plane = *plane_, .axis_point = levelled.inverse().translation()};
  std::vector<std::optional<ObjectView>> views(turn_.angles.size());
  for_each_stop(views.size(), threads_, [&](std::size_t stop) {
    if (!kept_[stop]) {
      kept_[stop] = turn_.read(stop);
      sample(stop, *kept_[stop]);
    }
    views[stop].emplace(*kept_[stop], turn_.intrinsics, mask);
    kept_[stop].reset();
  });
  plane_ = refine_platform_plane(samples_, turn_.platform_from_sensor, *plane_);
  TurnViews seen{.angles = turn_.angles, .pairs = make_stop_pairs(turn_.angles)};
  double pixels = 0;
  for (auto& view : views) {
    pixels += view->pixels();
    seen.views.push_back(*std::move(view));
  }
  const double each = pixels / static_cast<double>(std::max<std::size_t>(views.size(), 1));
  const int step = std::clamp(static_cast<int>(std::sqrt(each / readings_wanted)), 1, max_step);
  seen.correlation = uses + correlated_pixels / (step * step);
  for (const ObjectView& view : seen.views) {
    seen.readings.push_back(view.readings(step));
  }
  return seen;
}

}  // namespace octurn
