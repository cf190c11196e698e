#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// How far the platform turned, by what the stops saw of the object.
struct TurnRatio {
  double ratio = 1;  ///< seen angle by configured angle: 0 stood still, -1 turned the other way
  /// Shares of the readings that other stops confirm.
  double confirmed = 0;  ///< with `ratio`
  double as_told = 0;    ///< with the configured angles
  double still = 0;      ///< if the platform had not turned

  /// Whether the object looks the same from all sides: nothing shows how far the platform turned.
  bool is_alike() const;
};

/// Whether the depth images fit much better to a platform that did not turn than to `solved`.
bool looks_still(const TurnViews& turn, const Eigen::Isometry3d& levelled,
                 const Eigen::Isometry3d& solved, int threads);

/// Compares the ratios at which a turntable goes wrong: none, the other way, half and double, a
/// third and three times, a quarter and four times. Each gets an axis of its own.
/// @param turn   its angles are those at which the platform stood; they stay as they are
/// @param told   configured angles, radians
/// @param solved platform_from_sensor as solved with the configured angles
/// @param levelled  platform_from_sensor with the surface at z = 0, roughly
TurnRatio find_turn_ratio(TurnViews& turn, const std::vector<double>& told,
                          const PlatformPlane& plane, const Eigen::Isometry3d& levelled,
                          const Eigen::Isometry3d& solved, int threads);

/// Returns the finding of an object that looks the same from all sides, with a pose that is wrong.
CalibrationFinding describe_alike();

/// Returns the finding of a turntable that did not turn as configured: "still", "turn-ratio" or
/// "turn-unknown".
/// @return nothing if it turned as configured, or the object looks the same from all sides
std::optional<CalibrationFinding> find_wrong_turn(const TurnRatio& turn, std::size_t stops);

}  // namespace octurn
