#include "register/seen_turn.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>

#include "depth/depth_limits.hpp"
#include "parallel/fork_join.hpp"
#include "parallel/vector_levels.hpp"

namespace octurn {
namespace {

constexpr int block = 4;  // pixels along a side
constexpr int half_block = block * block / 2;
constexpr double free_margin = 0.006;  // metres: minimum distance of a surface behind a free point

std::size_t blocks(int pixels) { return static_cast<std::size_t>((pixels + block - 1) / block); }

/// Adds a row of pixels to the minimum and the number of the readings in each column. Minima are of
/// readings less 1, so that 0 (no reading) wraps to the largest value.
OCTURN_VECTOR_LEVELS
void add_row(const std::uint16_t* row, std::size_t width, std::uint16_t* min,
             std::uint16_t* count) {
  for (std::size_t u = 0; u < width; ++u) {
    const auto less_one = static_cast<std::uint16_t>(row[u] - 1U);
    min[u] = std::min(min[u], less_one);
    count[u] = static_cast<std::uint16_t>(count[u] + (row[u] > 0 ? 1U : 0U));
  }
}

}  // namespace

FreeDepths find_free_depths(const DepthFrame& frame) {
  const auto width = static_cast<std::size_t>(frame.width);
  FreeDepths depths;
  depths.reserve(blocks(frame.width) * blocks(frame.height));
  std::vector<std::uint16_t> min;
  std::vector<std::uint16_t> count;
  for (int v = 0; v < frame.height; v += block) {
    min.assign(width, std::numeric_limits<std::uint16_t>::max());
    count.assign(width, 0);
    for (int row = v; row < std::min(v + block, frame.height); ++row) {
      add_row(&frame.depth[static_cast<std::size_t>(row) * width], width, min.data(), count.data());
    }
    for (std::size_t u = 0; u < width; u += block) {
      std::uint16_t nearest = std::numeric_limits<std::uint16_t>::max();
      int readings = 0;
      for (std::size_t column = u; column < std::min(u + block, width); ++column) {
        nearest = std::min(nearest, min[column]);
        readings += count[column];
      }
      depths.push_back(readings >= half_block ? static_cast<std::uint16_t>(nearest + 1U)
                                              : std::uint16_t{0});
    }
  }
  return depths;
}

FreeRays::FreeRays(const Intrinsics& lens, std::span<const Eigen::Isometry3d> sensors_from_turn,
                   std::vector<FreeDepths> depths)
    : lens_(lens),
      poses_((sensors_from_turn.size() + at_once - 1) / at_once),
      depths_(std::move(depths)) {
  for (std::size_t stop = 0; stop < sensors_from_turn.size(); ++stop) {
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 4; ++column) {
        poses_[stop / at_once].rows[row][column][stop % at_once] = sensors_from_turn[stop].matrix()(
            static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      }
    }
  }
}

OCTURN_VECTOR_LEVELS
void FreeRays::see(const Intrinsics& lens, const Poses& poses, const Eigen::Vector3d& point,
                   Seen& seen) {
  const double fx = lens.fx;
  const double fy = lens.fy;
  const double cx = lens.cx;
  const double cy = lens.cy;
  const double px = point.x();
  const double py = point.y();
  const double pz = point.z();
  const auto& [of_x, of_y, of_z] = poses.rows;
  for (std::size_t i = 0; i < at_once; ++i) {
    const double x = of_x[0][i] * px + of_x[1][i] * py + of_x[2][i] * pz + of_x[3][i];
    const double y = of_y[0][i] * px + of_y[1][i] * py + of_y[2][i] * pz + of_y[3][i];
    const double z = of_z[0][i] * px + of_z[1][i] * py + of_z[2][i] * pz + of_z[3][i];
    seen.u[i] = x / z * fx + cx + 0.5;
    seen.v[i] = y / z * fy + cy + 0.5;
    seen.z[i] = z;
  }
}

bool FreeRays::passes(std::size_t stop, double u, double v, double z) const {
  if (!(z > nearest_z && u >= 0 && v >= 0 && u < lens_.width && v < lens_.height)) {
    return false;
  }
  const std::uint16_t free =
      depths_[stop][static_cast<std::size_t>(static_cast<int>(v) / block) * blocks(lens_.width) +
                    static_cast<std::size_t>(static_cast<int>(u) / block)];
  return free > 0 && free * lens_.depth_unit > z + free_margin;
}

bool FreeRays::pass(const Eigen::Vector3d& point, int min_stops) const {
  int stops = 0;
  Seen seen;
  for (std::size_t first = 0; first < depths_.size(); first += at_once) {
    see(lens_, poses_[first / at_once], point, seen);
    for (std::size_t i = 0; i < std::min(at_once, depths_.size() - first); ++i) {
      stops += passes(first + i, seen.u[i], seen.v[i], seen.z[i]) ? 1 : 0;
      if (stops >= min_stops) {
        return true;
      }
    }
  }
  return false;
}

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
