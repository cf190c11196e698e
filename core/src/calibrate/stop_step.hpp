#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>

#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// A motion of the object on the platform between two stops.
struct ObjectStep {
  std::size_t stop = 0;                             ///< the first at which it stood elsewhere
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< metres, platform frame at angle 0
  double sigma = 0;                                 ///< metres, of the shift
  double explained = 0;       ///< of the sum of squares of all residuals, that the shift explains
  double turn_explained = 0;  ///< the same of the best turn about the axis at a stop
};

/// Finds the stop from which on a shift of the object explains most of how the stops disagree.
///
/// At a stop whose object stands by s elsewhere, a residual N . (X_from - X_to) grows by N . s if
/// that is `from`, and falls by it if that is `to`. The normal equations of all stops' shifts and
/// turns are summed once; each hypothesis "by s from stop k on" is a projection of them on two
/// unknowns, and two more for an axis that the step has pulled aside.
/// @return nothing if too little of the object was seen twice
std::optional<ObjectStep> solve_object_step(const TurnViews& turn,
                                            const Eigen::Isometry3d& platform_from_sensor,
                                            int threads);

/// What a step says: that the object moved, if it is large, certain, and no turn explains it as
/// well.
std::optional<CalibrationFinding> find_move(const ObjectStep& step);

}  // namespace octurn
