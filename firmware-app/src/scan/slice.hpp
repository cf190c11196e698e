#pragma once

#include <Eigen/Core>
#include <vector>

namespace octurn {

/// What all stops saw within 1 mm of the object's plane y = 0: metres, x and z.
using Slice = std::vector<Eigen::Vector2d>;

/// Adds a point if it lies there. @param point  metres, object's frame
void add_to_slice(Slice& slice, const Eigen::Vector3d& point);

/// Every so many of its points that a picture is full.
Slice thinned(const Slice& slice);

}  // namespace octurn
