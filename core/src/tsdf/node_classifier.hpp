#pragma once

#include <Eigen/Core>

#include "tsdf/sensor_from_voxel.hpp"

namespace octurn {

/// What a snapshot says of a cube of voxels.
enum class NodeClass {
  outside,          ///< nothing: outside the view, or behind all surfaces
  free,             ///< each ray passed through
  free_to_surface,  ///< the same, and each ended on a surface
  partial,          ///< free in part, and no surface near
  near_surface,     ///< a surface may lie within the truncation
};

/// Classifies cubes of voxels by conservative bounds: those of their pixels, and the minimum and
/// maximum depth over these.
class NodeClassifier {
 public:
  /// @param depth  must outlive this
  NodeClassifier(const VoxelGrid& grid, const ConditionedDepth& depth,
                 const SensorFromVoxel& sensor_from_voxel);

  /// @param low     the cube's lowest voxel, counted from the grid's lowest corner
  /// @param voxels  along its side
  NodeClass classify(const Index3& low, int voxels) const;

 private:
  const ConditionedDepth& depth_;
  SensorFromVoxel sensor_from_voxel_;
  float truncation_;
  float half_depth_;             // of a voxel: half its extent along the sensor's Z
  Eigen::Array4f half_extents_;  // of a voxel along the sensor's X, X, Y, Y
  Eigen::Array4f focal_;         // fx, -fx, fy, -fy
  Eigen::Array4f centre_;        // cx, cx, cy, cy
};

}  // namespace octurn
