#pragma once

#include <Eigen/Geometry>
#include <string>

#include "octurn/scan_folder.hpp"

namespace octurn {

/// The camera's pose on a rig with lasers that is built to the drawing: 0.28 m in front of the
/// platform's axis, 0.18 m above its surface, looking 25 degrees down.
/// @return optical frame to platform frame, metres
Eigen::Isometry3d nominal_platform_from_camera();

/// A laser of that rig: 0.35 m from the platform's axis and 0.25 m above its surface. Its upright
/// plane of light holds the axis.
/// @param azimuth  radians from the camera's direction, seen from above; negative: to its left
/// @return in the camera's optical frame
Laser nominal_laser(std::string name, double azimuth);

/// A laser that was turned in its holder.
/// @param axis   through its source, of length one, optical frame
/// @param angle  radians about the axis
Laser turned_in_holder(const Laser& laser, const Eigen::Vector3d& axis, double angle);

}  // namespace octurn
