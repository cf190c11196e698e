#pragma once

#include <Eigen/Geometry>

#include "register/nearest_points.hpp"

namespace octurn {

/// Whether an object has the same shape by two poses of a turn: what the turn saw, placed by the
/// one, is on what is there by the other.
///
/// @param target  what other turns saw
/// @param turn    what the turn saw, in its own frame
/// @param one     target's frame from the turn's
/// @param other   the same
bool same_shape(const NearestPoints& target, const NearestPoints& turn,
                const Eigen::Isometry3d& one, const Eigen::Isometry3d& other);

}  // namespace octurn
