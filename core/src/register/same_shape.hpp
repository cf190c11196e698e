#pragma once

#include "register/nearest_points.hpp"
#include "register/pose_search.hpp"

namespace octurn {

/// Whether two poses of a turn give the same shape: nearly all points of the turn, placed by one
/// pose, lie on a surface that is there with the other. The tolerance is at least the residual that
/// target and turn have where they overlap.
///
/// @param target  what other turns saw
/// @param turn    what the turn saw, in its own frame
/// @param one     refined: its residual counts
/// @param other   the same
bool same_shape(const NearestPoints& target, const NearestPoints& turn, const PoseCandidate& one,
                const PoseCandidate& other);

}  // namespace octurn
