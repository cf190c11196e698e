#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <vector>

#include "depth/depth_pyramid.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A depth image in metres.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> z = {};  // row by row; 0 is no reading

  float at(int u, int v) const {
    return z[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
             static_cast<std::size_t>(u)];
  }
  const float* row(int v) const { return &z[static_cast<std::size_t>(v * width)]; }
  float* row(int v) { return &z[static_cast<std::size_t>(v * width)]; }
};

/// Metres: neighbouring readings further apart lie on different surfaces.
inline constexpr float depth_step_limit = 0.008F;

/// A plane in inverse depth, 1/z = inverse_depth + slope_u du + slope_v dv around a pixel.
///
/// A plane in space is linear in u and v there, and a sensor that measures disparity has the same
/// noise everywhere (Khoshelham and Elberink 2012).
struct PlaneFit {
  float inverse_depth = 0;  // at the pixel, 1/m
  float slope_u = 0;        // 1/m a pixel
  float slope_v = 0;
  int samples = 0;  // readings that it was fitted to
};

/// Side of the window that a plane is fitted in, pixels.
inline constexpr int fit_window_side = 5;

/// 1/z of each reading, 1/m; 0 where there is none.
std::vector<float> to_inverse_depth(const DepthImage& image);

/// Fits a plane to the readings of a 5 x 5 window that lie within `depth_step_limit` of its middle,
/// by weighted least squares.
///
/// @param u,v  at least two pixels inside the image, with a reading
/// @return nothing where fewer than nine readings agree, or all lie on a line
std::optional<PlaneFit> fit_plane(const DepthImage& image, const std::vector<float>& inverse_depth,
                                  int u, int v);

/// Drops readings without support: those with fewer than five of the nine readings in their 3 x 3
/// window, themselves included, within `depth_step_limit`. The image's border is dropped, too.
DepthImage remove_speckle(const DepthImage& image);

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
