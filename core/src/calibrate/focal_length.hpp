#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "calibrate/platform_plane.hpp"
#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// The sensor's focal length as a turn tells it.
struct FocalLength {
  double ratio = 1;  ///< of the true one to the told one
  double sigma = 0;  ///< of the ratio
};

/// Finds the focal length with which the stops agree best.
///
/// A focal length that is too large makes everything narrower by a factor and no nearer. It shows
/// in two ways as the object turns: what was across comes along the optical axis, and the platform,
/// which is seen askew, is tilted against the axis that it turns about. With points D P, D =
/// diag(s, s, 1), a residual N . (X_i - X_j) changes with s by M . Y'_i - n . Y'_j, where Y' = R D'
/// P + w' x Y + (0, 0, t'): w' and t' keep the plane, whose normal is (n_x / s, n_y / s, n_z), at z
/// = 0. Gauss-Newton over s, and over the axis as `solve_axis` does it.
///
/// A fixed pattern in the sensor's disparity bends the plane as a wrong focal length tilts it: this
/// is to be trusted only where a map has corrected it.
///
/// @param turn   changed: seen with the focal length that is found
/// @param plane  that the platform is with the told one
/// @param platform_from_sensor  solved with the told one
/// @return nothing if too little of the object was seen twice
std::optional<FocalLength> solve_focal_length(TurnViews& turn, PlatformPlane plane,
                                              Eigen::Isometry3d platform_from_sensor, int threads);

/// What a focal length says: that it is wrong, if it is by more than 1 % and five sigma.
/// @param told  pixels
std::optional<CalibrationFinding> find_wrong_focal_length(const FocalLength& solved, double told);

}  // namespace octurn
