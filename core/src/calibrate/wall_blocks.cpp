#include "calibrate/wall_blocks.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "depth/depth_limits.hpp"
#include "io/radial_distortion.hpp"
#include "octurn/median.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

constexpr int plane_iterations = 20;
constexpr double min_scale = 3 * disparity_unit;
constexpr double scale_of_median = 1.5;

/// Undistorts normalised coordinates. @param distortion  of the lens
Eigen::Vector2d undistorted(const Eigen::Vector2d& ray, const RadialDistortion& distortion) {
  return distortion.k1 == 0 && distortion.k2 == 0
             ? ray
             : Eigen::Vector2d(ray * distortion.undistorting_factor(ray.norm()));
}

/// @param lens  of the view, with the principal point and the focal lengths in force
WallBlock make_block(const WallView& view, const Intrinsics& lens, int first_u, int first_v,
                     int& pixels) {
  WallBlock block;
  int readings = 0;
  int all = 0;
  for (int v = first_v; v < std::min(first_v + block_side, lens.height); ++v) {
    for (int u = first_u; u < std::min(first_u + block_side, lens.width); ++u) {
      ++all;
      if (const double inverse_depth = view.inverse_depth(u, v); inverse_depth > 0) {
        block.ray += Eigen::Vector2d((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy);
        block.inverse_depth += inverse_depth;
        ++readings;
      }
    }
  }
  pixels += readings;
  block.is_valid = 2 * readings >= all;
  block.ray /= std::max(readings, 1);
  block.inverse_depth /= std::max(readings, 1);
  return block;
}

}  // namespace

WallView::WallView(const Intrinsics& intrinsics, std::optional<double> on_for)
    : intrinsics_(intrinsics),
      on_for_(on_for),
      sum_(static_cast<std::size_t>(intrinsics.width) *
           static_cast<std::size_t>(intrinsics.height)),
      readings_(sum_.size()) {}

void WallView::add(const DepthFrame& frame) {
  check_size(frame, intrinsics_, "WallView");
  ++frames_;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const double z = frame.depth[i] * intrinsics_.depth_unit;
    if (z > nearest_z) {
      sum_[i] += static_cast<float>(1 / z);
      ++readings_[i];
    }
  }
}

double WallView::inverse_depth(int u, int v) const {
  const auto i = static_cast<std::size_t>(v) * static_cast<std::size_t>(intrinsics_.width) +
                 static_cast<std::size_t>(u);
  const int readings = readings_[i];
  return readings > 0 && 2 * readings >= frames_ ? static_cast<double>(sum_[i]) / readings : 0;
}

WallBlocks make_wall_blocks(const WallView& view, const std::optional<SensorOptics>& optics) {
  const Intrinsics lens = optics ? rectified(view.intrinsics(), *optics) : view.intrinsics();
  const RadialDistortion distortion =
      optics ? RadialDistortion{.k1 = optics->k1, .k2 = optics->k2} : RadialDistortion{};
  WallBlocks wall{.columns = (lens.width + block_side - 1) / block_side,
                  .rows = (lens.height + block_side - 1) / block_side};
  int pixels = 0;
  for (int v = 0; v < lens.height; v += block_side) {
    for (int u = 0; u < lens.width; u += block_side) {
      wall.blocks.push_back(make_block(view, lens, u, v, pixels));
      wall.blocks.back().ray = undistorted(wall.blocks.back().ray, distortion);
    }
  }
  wall.coverage = pixels / (static_cast<double>(lens.width) * lens.height);
  return wall;
}

double WallPlane::slant() const {
  // Points (x z, y z, z) with 1/z = a + b x + c y lie on the plane b X + c Y + a Z = 1.
  return std::atan2(std::hypot(coefficients.y(), coefficients.z()), coefficients.x());
}

WallPlane fit_wall_plane(const WallBlocks& wall) {
  WallPlane plane;
  double scale = 0;  // none yet: all blocks weigh alike
  for (int iteration = 0; iteration < plane_iterations; ++iteration) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity() * 1e-9;  // also where nothing is seen
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (const WallBlock& block : wall.blocks) {
      if (!block.is_valid) {
        continue;
      }
      const double off = block.inverse_depth - plane.inverse_depth(block.ray);
      const double weight = scale > 0 ? cauchy_weight(off, scale) : 1;
      const Eigen::Vector3d row(1, block.ray.x(), block.ray.y());
      matrix += weight * row * row.transpose();
      right += weight * row * block.inverse_depth;
    }
    plane.coefficients = matrix.ldlt().solve(right);
    std::vector<double> residuals;
    for (const WallBlock& block : wall.blocks) {
      if (block.is_valid) {
        residuals.push_back(std::abs(block.inverse_depth - plane.inverse_depth(block.ray)));
      }
    }
    scale = std::max(min_scale, scale_of_median * median(std::move(residuals)));
  }
  return plane;
}

}  // namespace octurn
