#pragma once

#include <Eigen/Geometry>

namespace octurn {

/// Whether a matrix is a rotation and a translation and nothing else, within the rounding of
/// decimals in a file: |R R^T - 1| <= 1e-4, det R > 0, last row (0, 0, 0, 1).
bool is_rigid(const Eigen::Matrix4d& matrix);

/// The pose of the sensor in the frame of an object that turns with the platform.
///
/// The object's frame is the platform's at angle 0: right-handed, Z up, metres, origin at the
/// platform's centre on its surface.
///
/// @param platform_from_sensor  the calibration: optical frame to platform frame, metres
/// @param angle                 of the platform, radians, counter-clockwise seen from above
/// @return Rz(-angle) * platform_from_sensor
Eigen::Isometry3d object_from_sensor(const Eigen::Isometry3d& platform_from_sensor, double angle);

}  // namespace octurn
