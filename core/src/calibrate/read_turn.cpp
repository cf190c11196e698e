#include "calibrate/read_turn.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibrate/for_each_stop.hpp"
#include "calibrate/object_view.hpp"
#include "calibrate/platform_plane.hpp"

namespace octurn {
namespace {

constexpr std::size_t plane_stops = 6;  // enough to find the object above their plane
// Metres above the plane. The threshold selects readings that err towards the sensor, which biases
// the axis away from it. A low threshold keeps that to few of the readings of a flat object's
// walls.
constexpr double min_reading_height = 0.0025;
// Readings of the object that are used, per stop and per turn. More cost time and lower the sigma
// by little.
constexpr double stop_readings_wanted = 300;
constexpr double turn_readings_wanted = 24 * stop_readings_wanted;
constexpr int max_spacing = 8;  // pixels
constexpr double uses = 8;      // comparisons that share a reading and its error

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
      samples_(make_platform_samples(turn.intrinsics, turn.angles.size())),
      kept_(turn.angles.size()) {}

const std::optional<PlatformPlane>& TurnReader::find_platform() {
  const std::vector<std::size_t> stops = spread_stops(turn_.angles.size());
  for_each_stop(stops.size(), threads_, [&](std::size_t i) {
    const std::size_t stop = stops[i];
    kept_[stop] = turn_.read(stop);
    samples_.depths[stop] = sample_depths(*kept_[stop], turn_.intrinsics);
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
  const ObjectView::Mask mask{.plane = *plane_,
                              .axis_point = levelled.inverse().translation(),
                              .min_height = min_reading_height};
  std::vector<std::optional<ObjectView>> views(turn_.angles.size());
  for_each_stop(views.size(), threads_, [&](std::size_t stop) {
    if (!kept_[stop]) {
      kept_[stop] = turn_.read(stop);
      samples_.depths[stop] = sample_depths(*kept_[stop], turn_.intrinsics);
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
  const double wanted =
      std::min(stop_readings_wanted, turn_readings_wanted / static_cast<double>(views.size()));
  const int step = std::clamp(static_cast<int>(std::sqrt(each / wanted)), 1, max_spacing);
  seen.spacing = step;
  seen.correlation = uses + correlated_pixels / (step * step);
  for (const ObjectView& view : seen.views) {
    seen.readings.push_back(view.readings(step));
  }
  return seen;
}

}  // namespace octurn
