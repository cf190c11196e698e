#pragma once

#include <Eigen/Geometry>

#include "calibrate/stop_residuals.hpp"

namespace octurn {

/// Where to begin to look for the axis: as told, or where the object's outline turns about,
/// whichever has the stops agree better. A flat object that is told 2 cm beside its place overlaps
/// itself so little at its sides that nothing would pull it back.
///
/// Over a whole turn, the middle between an outline's left and right ends is the axis on average,
/// and its nearest end is as far before the axis as these are beside it: averages of the support
/// function of its convex hull.
///
/// @param levelled  optical frame to platform frame as told, with the platform's surface at z = 0
Eigen::Isometry3d find_axis_start(const TurnViews& turn, const Eigen::Isometry3d& levelled,
                                  int threads);

}  // namespace octurn
