#pragma once

#include <Eigen/Geometry>

#include "calibrate/stop_residuals.hpp"

namespace octurn {

/// Initial axis for `solve_axis`: the configured one, or the one about which the object's outline
/// turns, whichever has the smaller residuals. From a configured axis 2 cm off, the sides of a flat
/// object overlap so little that the solver would not converge.
///
/// Averaged over a whole turn, the middle between the outline's left and right ends is the axis,
/// and its nearest end is as far in front of the axis as these are beside it: both are averages of
/// the support function of its convex hull.
///
/// @param levelled  optical frame to platform frame as configured, with the platform's surface at z
/// = 0
Eigen::Isometry3d find_axis_start(const TurnViews& turn, const Eigen::Isometry3d& levelled,
                                  int threads);

}  // namespace octurn
