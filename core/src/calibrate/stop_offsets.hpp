#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// How far the platform stood from where it was told, at each stop.
struct StopOffsets {
  std::vector<double> offsets = {};  ///< radians, as seen less as told; 0 at the first stop
  Eigen::MatrixXd covariance = {};   ///< of those of the stops from the second on
};

/// Solves the angle of each stop but the first from how the stops disagree about the object, the
/// axis given: Gauss-Newton as in `solve_axis`, with a rotation about z for each stop.
/// @return nothing if the object does not tell the angles, as one of revolution does not
std::optional<StopOffsets> solve_stop_offsets(const TurnViews& turn,
                                              const Eigen::Isometry3d& platform_from_sensor,
                                              int threads);

/// What the offsets say: steps between neighbouring stops are slips; a steady drift is a turn that
/// is not 360 degrees.
std::vector<CalibrationFinding> find_slips(const std::vector<double>& angles,
                                           const StopOffsets& solved);

}  // namespace octurn
