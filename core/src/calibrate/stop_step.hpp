#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>

#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// A motion of the object on the platform between two stops.
struct ObjectStep {
  std::size_t stop = 0;                             ///< the first after the motion
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< metres, platform frame at angle 0
  double sigma = 0;                                 ///< metres, of the shift
  double explained = 0;       ///< share of the sum of squares of all residuals
  double turn_explained = 0;  ///< the same of the best turn about the axis at a stop
};

/// Finds the stop at which a shift of the object explains most of the residuals.
///
/// A shift s of the object at one stop changes a residual N . (X_from - X_to) by N . s if that stop
/// is `from`, and by -N . s if it is `to`. The normal equations of all stops' shifts and turns are
/// summed once. Each hypothesis "shifted by s from stop k on" is a projection of them on two
/// unknowns, and two more for the axis, which the shift has biased.
/// @return nothing if too few readings of the object have a partner
std::optional<ObjectStep> solve_object_step(const TurnViews& turn,
                                            const Eigen::Isometry3d& platform_from_sensor,
                                            int threads);

/// Smaller shifts of the object are no finding, metres.
inline constexpr double min_move_shift = 0.001;

/// The finding "moved" of the object, if the step is large, certain, and no turn explains the
/// residuals as well.
std::optional<CalibrationFinding> find_move(const ObjectStep& step);

}  // namespace octurn
