#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "octurn/sensor_map.hpp"

namespace octurn {

/// Side of a block, pixels: finer than a sensor's correlation window, of some 9 pixels.
inline constexpr int block_side = 4;

/// The mean reading of 4 x 4 pixels of a wall.
struct WallBlock {
  /// Where its readings are: (x, y) = ((u - cx) / fx, (v - cy) / fy), undistorted.
  Eigen::Vector2d ray = Eigen::Vector2d::Zero();
  double inverse_depth = 0;  ///< 1/m
  bool is_valid = false;     ///< it has readings at half of its pixels or more
};

/// A view of a wall in blocks.
struct WallBlocks {
  int columns = 0;
  int rows = 0;
  std::vector<WallBlock> blocks = {};  ///< columns x rows
  double coverage = 0;                 ///< share of the pixels that have a reading
};

/// @param optics  of the sensor, if they are not those that the view's intrinsics tell
WallBlocks make_wall_blocks(const WallView& view, const std::optional<SensorOptics>& optics = {});

/// A plane in inverse depth: 1/z = a + b x + c y along the ray (x, y, 1).
struct WallPlane {
  Eigen::Vector3d coefficients = Eigen::Vector3d::Zero();  ///< a, b, c, 1/m

  double inverse_depth(const Eigen::Vector2d& ray) const {
    return coefficients.x() + coefficients.y() * ray.x() + coefficients.z() * ray.y();
  }
  /// Metres, along the optical axis.
  double distance() const { return 1 / coefficients.x(); }
  /// Radians, between the optical axis and the plane's normal.
  double slant() const;
};

/// Fits a plane to the blocks with readings by least squares with Cauchy weights, whose scale falls
/// to three steps of a Kinect's disparity: things that hang on the wall have no influence.
WallPlane fit_wall_plane(const WallBlocks& wall);

}  // namespace octurn
