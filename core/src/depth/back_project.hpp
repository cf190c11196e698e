#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "depth/seen_pixels.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The points of a snapshot or of a rectangle of it, in the order of its depth image. A sample
/// without a reading, or outside the clip box, is `no_point`: not a number, so that every
/// comparison with it is false.
struct PointGrid {
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector3f> points = {};  // metres, object's frame, row by row
};

inline const Eigen::Vector3f no_point =
    Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

inline bool is_point(const Eigen::Vector3f& point) { return !std::isnan(point.x()); }

/// Back-projects a snapshot's samples into the object's frame, by the pinhole formula of
/// `Intrinsics`.
///
/// Deterministic: the same snapshot gives the same bits on x86-64 and arm64.
/// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
PointGrid world_points(const Snapshot& snapshot);

/// The same for the pixels of a rectangle, which must lie in the depth image.
PointGrid world_points(const Snapshot& snapshot, const PixelRectangle& pixels);

/// Replaces the points outside `box` (metres, object's frame) by `no_point`; those on its faces
/// stay.
void clip(PointGrid& grid, const Box& box);

/// Clips points for one of several poses: drops points outside the pose's own clip box, or less
/// than 2.5 mm above its platform. Remaining points that noise puts up to 5 mm below the first
/// pose's platform are raised to it.
void clip(PointGrid& grid, const Placement& placement);

}  // namespace octurn
