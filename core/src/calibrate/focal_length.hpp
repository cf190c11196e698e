#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "calibrate/platform_plane.hpp"
#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// The sensor's focal length as solved from a turn.
struct FocalLength {
  double ratio = 1;  ///< of the true one to the told one
  double sigma = 0;  ///< of the ratio
};

/// Finds the focal length with the smallest residuals between stops.
///
/// A focal length that is too large shrinks everything across the optical axis, but not along it.
/// It shows in two ways: as the object turns, lengths across the axis turn into lengths along it,
/// and the platform, which is seen at an angle, is tilted against its turning axis. With points D
/// P, D = diag(s, s, 1), a residual N . (X_i - X_j) changes with s by M . Y'_i - n . Y'_j, where Y'
/// = R D' P + w' x Y + (0, 0, t'): w' and t' keep the plane, whose normal is (n_x / s, n_y / s,
/// n_z), at z = 0. Gauss-Newton over s, and over the axis as `solve_axis` does it.
///
/// A fixed pattern in the sensor's disparity has nearly the same effect on the plane: the result
/// can be trusted only if a `SensorMap` was applied.
///
/// @param turn   changed: scaled to the focal length that is found
/// @param plane  of the platform, with the told focal length
/// @param platform_from_sensor  solved with the told one
/// @return nothing if too few readings of the object have a partner
std::optional<FocalLength> solve_focal_length(TurnViews& turn, PlatformPlane plane,
                                              Eigen::Isometry3d platform_from_sensor, int threads);

/// The finding "focal-length", if it is wrong by more than 1 % and five sigma.
/// @param told  pixels
std::optional<CalibrationFinding> find_wrong_focal_length(const FocalLength& solved, double told);

}  // namespace octurn
