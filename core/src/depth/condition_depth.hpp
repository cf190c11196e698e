#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "depth/depth_observation.hpp"
#include "depth/depth_pyramid.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A snapshot conditioned for integration: speckle is removed, noise is smoothed by a plane fitted
/// at each pixel, and each surface has a weight: its inverse variance, relative to a whole window
/// that faces the sensor at nine tenths of the depth of the platform's middle, where an object
/// stands.
class ConditionedDepth {
 public:
  /// @param clip  metres, object's frame: readings outside make no surface, but show free space
  /// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
  ConditionedDepth(const Snapshot& snapshot, const Box& clip);

  /// Conditions a snapshot of one of several poses: readings outside the pose's own clip box, or
  /// less than 2.5 mm above its platform, make no surface either. Readings up to 7 mm have less
  /// weight, as they may mix object and platform.
  ConditionedDepth(const Snapshot& snapshot, const Box& clip, const Placement& placement);

  /// Conditions a snapshot of a space without a platform.
  /// @param reference_depth  metres, at which a whole window has weight 1
  ConditionedDepth(const Snapshot& snapshot, const Box& clip, double reference_depth);

  /// Takes observations from elsewhere, such as laser lines.
  /// @param observations  of the intrinsics' size, row by row
  ConditionedDepth(const Intrinsics& intrinsics, const Eigen::Isometry3d& sensor_from_object,
                   std::vector<DepthObservation> observations);

  const Intrinsics& intrinsics() const { return intrinsics_; }
  const Eigen::Isometry3d& sensor_from_object() const { return sensor_from_object_; }

  /// @param u,v  a pixel of the image; the outer two rows and columns observe nothing
  const DepthObservation& at(int u, int v) const { return at(v * intrinsics_.width + u); }

  /// @param pixel  v * width + u
  const DepthObservation& at(int pixel) const {
    return observations_[static_cast<std::size_t>(pixel)];
  }

  /// Bounds of what a rectangle of pixels observes, first and last included.
  DepthPyramid::MinMax min_max(int u0, int v0, int u1, int v1) const {
    return pyramid_.min_max(u0, v0, u1, v1);
  }

 private:
  ConditionedDepth(const Snapshot& snapshot, std::vector<DepthObservation> observations);

  Intrinsics intrinsics_;
  Eigen::Isometry3d sensor_from_object_;
  std::vector<DepthObservation> observations_;
  DepthPyramid pyramid_;
};

}  // namespace octurn
