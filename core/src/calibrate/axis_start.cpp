#include "calibrate/axis_start.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <vector>

#include "calibrate/for_each_stop.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;

/// Ends of an outline, metres.
struct Outline {
  double left = std::numeric_limits<double>::max();
  double right = std::numeric_limits<double>::lowest();
  double near = std::numeric_limits<double>::max();
};

/// Agreement of the stops with a pose: the sum of the residuals' weights. A reading without a
/// surface near adds none.
double agreement(const TurnViews& turn, const Isometry3d& pose, int threads) {
  const std::vector<double> as_told(turn.angles.size(), 0.0);
  std::vector<double> of_stops(turn.views.size());
  constexpr ResidualLimits limits;
  for_each_stop(of_stops.size(), threads, [&](std::size_t stop) {
    for_each_residual(turn, pose, as_told, stop, limits, [&](const StopResidual& residual) {
      of_stops[stop] += limits.weight(residual.distance);
    });
  });
  return std::accumulate(of_stops.begin(), of_stops.end(), 0.0);
}

}  // namespace

Isometry3d find_axis_start(const TurnViews& turn, const Isometry3d& levelled, int threads) {
  const Vector2d away = -Vector2d(levelled.translation().head<2>()).normalized();
  const Vector2d aside(away.y(), -away.x());
  double beside = 0;
  double before = 0;
  double stops = 0;
  for (const std::vector<SurfaceReading>& readings : turn.readings) {
    Outline outline;
    for (const SurfaceReading& reading : readings) {
      const Vector2d point = (levelled * reading.point).head<2>();
      outline.left = std::min(outline.left, aside.dot(point));
      outline.right = std::max(outline.right, aside.dot(point));
      outline.near = std::min(outline.near, away.dot(point));
    }
    if (!readings.empty()) {
      beside += (outline.left + outline.right) / 2;
      before += outline.near + (outline.right - outline.left) / 2;
      ++stops;
    }
  }
  if (!(stops > 0)) {
    return levelled;
  }
  const Vector2d middle = beside / stops * aside + before / stops * away;
  const Isometry3d seen = Eigen::Translation3d(-middle.x(), -middle.y(), 0) * levelled;
  return agreement(turn, seen, threads) > agreement(turn, levelled, threads) ? seen : levelled;
}

}  // namespace octurn
