#pragma once

#include "register/nearest_points.hpp"
#include "register/pose_search.hpp"

namespace octurn {

/// Whether two poses of a turn give the same shape: 98 % of the turn's points, placed by either
/// pose, lie on the target or on the turn placed by the other pose. The tolerance is 1.5 mm, or
/// three times the residual if that is more.
///
/// @param target      points of the placed turns
/// @param turn        points of the turn, in its own frame
/// @param one, other  refined, as the smaller residual sets the tolerance
bool same_shape(const NearestPoints& target, const NearestPoints& turn, const PoseCandidate& one,
                const PoseCandidate& other);

}  // namespace octurn
