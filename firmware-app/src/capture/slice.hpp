#pragma once

#include <Eigen/Core>
#include <vector>

namespace octurn {

/// Cross-section of the object: all stops' points within 1 mm of the plane y = 0 of its frame, x
/// and z, metres.
using Slice = std::vector<Eigen::Vector2d>;

/// Adds a point if it lies in the slice. @param point  metres, object's frame
void add_to_slice(Slice& slice, const Eigen::Vector3d& point);

/// Returns every n-th point, at most 3000: enough for a picture.
Slice thinned(const Slice& slice);

}  // namespace octurn
