#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "depth/pinhole.hpp"
#include "octurn/median.hpp"
#include "octurn/tiles.hpp"

namespace octurn {
namespace {

constexpr double same_depth = 0.05;  // of the depth: several times the noise of any sensor
constexpr int grid_columns = 40;
constexpr std::size_t most_views = 24;
constexpr std::size_t most_pixels = std::size_t{24} << 20U;  // of all views: 48 MB

/// A reading in metres; 0 is none.
double depth_at(const Snapshot& view, int u, int v) {
  const auto index = static_cast<std::size_t>(v * view.frame.width + u);
  return view.frame.depth[index] * view.intrinsics.depth_unit;
}

/// Looks up each reading of one view, on a grid, in another view.
void look_up(const Snapshot& view, const Snapshot& other, ViewAgreement& found,
             std::vector<double>& gaps) {
  const Eigen::Isometry3d other_from_view =
      other.object_from_sensor.inverse() * view.object_from_sensor;
  const int step = std::max(1, view.frame.width / grid_columns);
  for (int v = step / 2; v < view.frame.height; v += step) {
    for (int u = step / 2; u < view.frame.width; u += step) {
      const double depth = depth_at(view, u, v);
      const Eigen::Vector3d point = other_from_view * (depth * to_ray(view.intrinsics, u, v));
      if (depth == 0 || !(point.z() > 0)) {
        continue;
      }
      const Eigen::Array2d pixel = project(other.intrinsics, point).array().round();
      if (!((pixel >= 0).all() && pixel.x() < other.frame.width &&
            pixel.y() < other.frame.height)) {
        continue;
      }
      const double seen = depth_at(other, static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
      if (seen == 0) {
        continue;
      }
      ++found.compared;
      const double gap = point.z() - seen;
      if (std::abs(gap) <= same_depth * seen) {
        ++found.agreeing;
        gaps.push_back(std::abs(gap));
      } else if (gap < 0) {
        ++found.contradicted;
      }
    }
  }
}

}  // namespace

double ViewAgreement::share() const {
  const std::size_t judged = agreeing + contradicted;
  return judged == 0 ? 1 : static_cast<double>(agreeing) / static_cast<double>(judged);
}

ViewAgreement compare_views(std::span<const Snapshot> views) {
  ViewAgreement found;
  std::vector<double> gaps;
  for (const Snapshot& view : views) {
    for (const Snapshot& other : views) {
      if (&view != &other) {
        look_up(view, other, found, gaps);
      }
    }
  }
  found.gap = median(std::move(gaps));
  return found;
}

std::vector<Snapshot> spread_views(const SnapshotSource& snapshots) {
  std::vector<Snapshot> views;
  if (snapshots.count == 0) {
    return views;
  }
  views.push_back(snapshots.read(0));
  const std::size_t pixels = std::max<std::size_t>(views.front().frame.depth.size(), 1);
  const std::size_t number =
      std::min({snapshots.count, most_views, std::max<std::size_t>(most_pixels / pixels, 2)});
  for (std::size_t i = 1; i < number; ++i) {
    views.push_back(snapshots.read(i * snapshots.count / number));
  }
  return views;
}

}  // namespace octurn
