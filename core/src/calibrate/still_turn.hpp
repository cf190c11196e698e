#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// The verdict on a turn whose platform stood still.
struct StillTurn {
  std::string reason = {};  ///< why its pose is refused
  /// These replace the turn's findings; none if an object of revolution may have turned.
  std::vector<CalibrationFinding> findings = {};
};

/// Detects a platform that stood still: every stop of the turn shows the same as the first, and the
/// object is not one of revolution. It is one of revolution if the pose could be solved, and the
/// readings of the first stop, turned by the angle of any other stop, lie nowhere in free space.
/// @return nothing if the platform turned
/// @param levelled   platform_from_sensor with the surface at z = 0, roughly
/// @param solved     platform_from_sensor as solved
/// @param is_solved  whether `solved` would be accepted
std::optional<StillTurn> find_still_turn(const PlatformSamples& samples,
                                         const CalibrationTurn& turn,
                                         const Eigen::Isometry3d& levelled,
                                         const Eigen::Isometry3d& solved, bool is_solved);

}  // namespace octurn
