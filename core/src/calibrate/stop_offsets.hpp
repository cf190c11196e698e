#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// The platform's angle at each stop, less the configured one.
struct StopOffsets {
  std::vector<double> offsets = {};  ///< radians, measured less configured; 0 at the first stop
  Eigen::MatrixXd covariance = {};   ///< of the offsets from the second stop on
};

/// Solves the angle of each stop except the first, with the axis given: Gauss-Newton as in
/// `solve_axis`, with a rotation about z for each stop.
/// @return nothing if the object does not determine the angles, as one of revolution
std::optional<StopOffsets> solve_stop_offsets(const TurnViews& turn,
                                              const Eigen::Isometry3d& platform_from_sensor,
                                              int threads);

/// The finding "slip". @param angle  radians
CalibrationFinding describe_slip(int stop, double angle);

/// Findings from the offsets: each step between neighbouring stops is a "slip", a steady drift is
/// "turn-not-whole".
std::vector<CalibrationFinding> find_slips(const std::vector<double>& angles,
                                           const StopOffsets& solved);

/// How far the platform had slipped at each stop, radians: the median offset between two slips,
/// less that before the first.
std::vector<double> slipped_angles(const std::vector<CalibrationFinding>& findings,
                                   const StopOffsets& solved);

}  // namespace octurn
