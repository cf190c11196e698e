#pragma once

#include <Eigen/Geometry>
#include <string>

#include "octurn/scan_folder.hpp"

namespace octurn {

/// The camera's pose on a rig with lasers that is built to the drawing: 0.28 m in front of the
/// platform's axis, 0.18 m above its surface, looking 25 degrees down.
/// @return optical frame to platform frame, metres
Eigen::Isometry3d nominal_platform_from_camera();

/// A laser of that rig: 0.35 m from the platform's axis and 0.25 m above its surface. Its vertical
/// plane of light contains the axis.
/// @param azimuth  radians from the camera's direction, seen from above; negative: to its left
/// @return in the camera's optical frame
Laser nominal_laser(std::string name, double azimuth);

/// Rotates a laser in its holder, about an axis through its source.
/// @param axis   unit vector, optical frame
/// @param angle  radians
Laser turned_in_holder(const Laser& laser, const Eigen::Vector3d& axis, double angle);

}  // namespace octurn
