#include "register/free_rays.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "depth/depth_limits.hpp"
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

}  // namespace octurn
