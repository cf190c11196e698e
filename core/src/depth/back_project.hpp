#pragma once

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include "octurn/box.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The points of a snapshot, in the order of its depth image. A point without a reading, or
/// clipped away, is `no_point`: not a number, so that every comparison with it is false.
struct PointGrid {
  int width = 0;
  int height = 0;
  std::vector<Eigen::Vector3f> points = {};  // metres, platform frame at angle 0
};

inline const Eigen::Vector3f no_point =
    Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

inline bool is_point(const Eigen::Vector3f& point) { return !std::isnan(point.x()); }

/// The points of a snapshot in the frame that turns with the platform.
///
/// Deterministic: the same snapshot gives the same bits on x86-64 and arm64.
/// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
PointGrid world_points(const Snapshot& snapshot);

/// Takes away the points outside `box` (metres); those on its faces stay.
void clip(PointGrid& grid, const Box& box);

}  // namespace octurn
