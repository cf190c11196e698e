#include "register/seen_turn.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "octurn/snapshot.hpp"
#include "parallel/fork_join.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double platform_margin = 0.004;   // metres: lower readings may be the platform's
constexpr double cell_side = 0.002;         // metres
constexpr std::size_t many_stops = 16;      // from here on every other pixel is enough
constexpr std::size_t min_readings = 3;     // in a cell
constexpr double min_cell_agreement = 0.7;  // length of the mean normal of a cell
constexpr double max_below_platform =
    0.004;                        // metres: a point lower than this is inside the platform
constexpr int min_witnesses = 2;  // stops that see through a point

struct Cell {
  Vector3d point = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();
  std::size_t count = 0;
};

using CellKey = std::tuple<int, int, int>;

CellKey to_key(const Vector3d& point) {
  const auto at = [&](Eigen::Index axis) {
    return static_cast<int>(std::floor(point[axis] / cell_side));
  };
  return {at(2), at(1), at(0)};
}

std::vector<SurfacePoint> mean_points(const std::vector<std::vector<SurfacePoint>>& of_stops) {
  std::map<CellKey, Cell> cells;
  for (const std::vector<SurfacePoint>& readings : of_stops) {
    for (const SurfacePoint& reading : readings) {
      Cell& cell = cells[to_key(reading.point)];
      cell.point += reading.point;
      cell.normal += reading.normal;
      ++cell.count;
    }
  }
  std::vector<SurfacePoint> points;
  for (const auto& [key, cell] : cells) {
    const auto count = static_cast<double>(cell.count);
    if (cell.count >= min_readings && cell.normal.norm() > min_cell_agreement * count) {
      points.push_back({.point = cell.point / count, .normal = cell.normal.normalized()});
    }
  }
  return points;
}

}  // namespace

SeenTurn read_turn(const RegistrationTurn& turn, int threads, const std::stop_token& stop) {
  Box object = turn.clip;
  object.min.z() = std::max(object.min.z(), platform_margin);
  const auto inverse_depths =
      std::make_shared<const std::vector<double>>(to_inverse_depths(turn.intrinsics.depth_unit));
  std::vector<std::optional<StopView>> views(turn.angles.size());
  std::vector<FreeDepths> free(views.size());
  std::vector<std::vector<SurfacePoint>> readings(views.size());
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int) {
    for (std::size_t i = next++; i < views.size(); i = next++) {
      throw_if_stopped(stop);
      const DepthFrame frame = turn.read(i);
      views[i].emplace(frame, turn.intrinsics,
                       object_from_sensor(turn.platform_from_sensor, turn.angles[i]), object,
                       inverse_depths);
      free[i] = find_free_depths(frame);
      readings[i] = views[i]->readings(views.size() < many_stops ? 1 : 2);
    }
  });
  SeenTurn seen{.points = mean_points(readings)};
  std::vector<Eigen::Isometry3d> sensors_from_turn;
  for (auto& view : views) {
    sensors_from_turn.push_back(view->sensor_from_turn());
    seen.stops.push_back(*std::move(view));
  }
  seen.free_rays = FreeRays(turn.intrinsics, sensors_from_turn, std::move(free));
  return seen;
}

std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, std::size_t count) {
  if (points.size() <= count) {
    return points;
  }
  std::vector<SurfacePoint> some;
  some.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    some.push_back(points[i * points.size() / count]);
  }
  return some;
}

Vector3d find_middle(const std::vector<SurfacePoint>& points) {
  Eigen::AlignedBox3d box;
  for (const SurfacePoint& point : points) {
    box.extend(point.point);
  }
  return box.center();
}

bool contradicts(const SeenTurn& turn, const Vector3d& point) {
  if (point.z() < -max_below_platform) {
    return true;
  }
  return turn.free_rays.pass(point, min_witnesses);
}

double contradicted_share(const SeenTurn& turn, const std::vector<SurfacePoint>& points,
                          const Eigen::Isometry3d& turn_from_points) {
  const auto contradicted = std::ranges::count_if(points, [&](const SurfacePoint& point) {
    return contradicts(turn, turn_from_points * point.point);
  });
  return points.empty() ? 0
                        : static_cast<double>(contradicted) / static_cast<double>(points.size());
}

}  // namespace octurn
