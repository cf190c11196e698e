#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Whether every stop of a turn shows what the first one shows: the platform stood still, or what
/// stands on it looks the same from all sides.
/// @param platform_from_sensor  with the surface at z = 0, roughly
bool looks_still(const PlatformSamples& samples, const Eigen::Isometry3d& platform_from_sensor);

/// Whether what the first stop shows, turned by the angle of any other, lies where that first stop
/// sees nothing further away: so it is with an object of revolution about the axis.
/// @param platform_from_sensor  as solved
/// @param angles                of the stops, radians
bool looks_round(const PlatformSamples& samples, const Intrinsics& lens,
                 const Eigen::Isometry3d& platform_from_sensor, const std::vector<double>& angles);

}  // namespace octurn
