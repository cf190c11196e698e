#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// What is said of a turn whose platform stood still.
struct StillTurn {
  std::string reason = {};  ///< why its pose is refused
  /// In place of those of a turn; none if an object of revolution may have turned.
  std::vector<CalibrationFinding> findings = {};
};

/// Finds a platform that stood still: every stop of the turn shows what the first one shows, and no
/// object of revolution explains that. One does if the pose could be solved, and what the first
/// stop shows, turned by the angle of any other, lies where it sees nothing further away.
/// @return nothing if the platform turned
/// @param levelled   platform_from_sensor with the surface at z = 0, roughly
/// @param solved     platform_from_sensor as solved
/// @param is_solved  whether that would be accepted
std::optional<StillTurn> find_still_turn(const PlatformSamples& samples,
                                         const CalibrationTurn& turn,
                                         const Eigen::Isometry3d& levelled,
                                         const Eigen::Isometry3d& solved, bool is_solved);

}  // namespace octurn
