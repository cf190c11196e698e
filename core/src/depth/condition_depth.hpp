#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "octurn/box.hpp"
#include "octurn/depth_frame.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// What one pixel says about space, in the sensor's frame, metres.
struct DepthObservation {
  std::array<float, 3> normal = {};  // of the surface's tangent plane, towards the sensor
  float offset = 0;                  // normal . point + offset = distance to that plane
  float weight = 0;                  // of that surface; 0: there is none
  float free_space_depth = 0;        // up to which the ray is free; 0: nothing is known
};

/// A snapshot, conditioned to be fused: noise is smoothed where the surface lets it, each reading
/// has a weight that says how far it can be trusted, and doubtful ones are left out.
class ConditionedDepth {
 public:
  /// @param clip  metres, platform frame: what lies outside makes no surface
  ConditionedDepth(const Snapshot& snapshot, const Box& clip);

  const Intrinsics& intrinsics() const { return intrinsics_; }
  const Eigen::Isometry3d& sensor_from_object() const { return sensor_from_object_; }

  /// @param u,v  in the image; nothing is known at its edges
  const DepthObservation& at(int u, int v) const { return at(v * intrinsics_.width + u); }

  /// @param pixel  in row-major order
  const DepthObservation& at(int pixel) const { return sights_[static_cast<std::size_t>(pixel)]; }

  /// Bounds to what a rectangle of pixels says.
  struct Range {
    float least =
        0;  // of `free_space_depth`: 0 if there is nothing known of some, or they are no pixels
    float greatest = 0;
    float nearest_surface = 0;  // z of the pixels with a weight; more than the farthest: none
    float farthest_surface = 0;
  };
  Range range(int u0, int v0, int u1, int v1) const;

 private:
  /// Least, nearest surface, and the others below zero, so that all are extended by a minimum.
  using Bounds = Eigen::Array4f;
  Bounds bounds_of(int u0, int v0, int u1, int v1) const;
  void build_pyramid();

  struct Level {
    int width = 0;
    int height = 0;
    std::vector<Bounds> bounds = {};
  };

  Intrinsics intrinsics_;
  Eigen::Isometry3d sensor_from_object_;
  std::vector<DepthObservation> sights_ = {};
  std::vector<Level> pyramid_ = {};  // level i has texels of 4 << i pixels
};

}  // namespace octurn
