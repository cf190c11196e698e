#pragma once

#include <Eigen/Geometry>

namespace octurn {

/// Whether a matrix is a rotation and a translation and nothing else, as far as the rounded
/// decimals of a file can tell.
bool is_rigid(const Eigen::Matrix4d& matrix);

/// Where an object that turns with the platform was seen from.
///
/// @param platform_from_sensor  the calibration: optical frame to platform frame, metres
/// @param angle                 of the platform, radians, counter-clockwise seen from above
/// @return Rz(-angle) * platform_from_sensor: optical frame to the frame that turns along
Eigen::Isometry3d object_from_sensor(const Eigen::Isometry3d& platform_from_sensor, double angle);

}  // namespace octurn
