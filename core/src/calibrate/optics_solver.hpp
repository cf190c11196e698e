#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "calibrate/axis_solver.hpp"
#include "calibrate/platform_plane.hpp"
#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// The sensor's optics and the turning axis, as solved together from a turn.
struct OpticsSolution {
  SolvedOptics optics = {};
  AxisSolution axis = {};  ///< its covariance is that with these optics
  /// Squared Mahalanobis distance of the optics from their prior: chi^2 of 4 degrees if these are
  /// right, of one if only the focal length was solved.
  double significance = 0;
  bool is_better = false;  ///< far smaller sigmas than those of known optics
};

/// Finds the optics with the smallest residuals: those of `solve_axis` between stops, and the
/// platform's, which must be flat and square to the axis.
///
/// Optics that are wrong deform what each stop sees in the sensor's frame, and the object turns in
/// it: lengths across the optical axis turn into lengths along it (focal length), and right angles
/// between them are sheared (principal point). Deformations that turn with the object, above all
/// the overall scale, no turn shows: the depth's scale and offset stay as they are. Members that
/// the turn does not determine stay near their prior. Those of a data sheet have the spread of
/// published units: 1.5 % of the focal length, 8 pixels of the principal point, 0.08 of k1. Known
/// ones have their own sigmas, so that the result is the weighted mean of them and the turn's.
///
/// Gauss-Newton. A point z (x, y, 1) changes with the relative focal length by -z (x, y, 0), with
/// the principal point by -z / f, and with k1 by -z r^2 (x, y, 0). Its residual N . (X_i - X_j)
/// changes by M . R D_i - n . R D_j, and a height above the platform by (R D)_z.
///
/// @param views  changed: read with the optics that are found
/// @param plane  of the platform, with the turn's intrinsics
/// @param turn   its intrinsics, and its optics if they are known
/// @param start  solved with the turn's intrinsics: optical frame to platform frame
/// @param pattern  how uneven a sensor without a map sees the platform, units of disparity: then
///                 the focal length alone is solved. 0: the sensor is even, or has a map
/// @return nothing if too few readings of the object have a partner
std::optional<OpticsSolution> solve_optics(TurnViews& views, const PlatformSamples& samples,
                                           const PlatformPlane& plane, const CalibrationTurn& turn,
                                           const Eigen::Isometry3d& start, double pattern,
                                           int threads);

/// The finding "optics", of optics that were solved and are not applied.
CalibrationFinding describe_unused_optics(const SensorOptics& solved, const Intrinsics& used);

/// The finding "focal-length", of optics that are too far off to be a Kinect's.
/// @param seen, configured  pixels
CalibrationFinding describe_focal_length(double seen, double configured);

}  // namespace octurn
