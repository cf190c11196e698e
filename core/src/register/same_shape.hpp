#pragma once

#include "register/nearest_points.hpp"
#include "register/pose_search.hpp"

namespace octurn {

/// Whether an object has the same shape by two poses of a turn: what the turn saw, placed by the
/// one, is on what is there by the other, to within what the turns differ by where both saw it.
///
/// @param target  what other turns saw
/// @param turn    what the turn saw, in its own frame
/// @param one     refined: its residual counts
/// @param other   the same
bool same_shape(const NearestPoints& target, const NearestPoints& turn, const PoseCandidate& one,
                const PoseCandidate& other);

}  // namespace octurn
