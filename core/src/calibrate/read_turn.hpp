#pragma once

#include <optional>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "calibrate/stop_residuals.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {

/// Reads the depth images of a turn, each once. The platform's plane is found from a few stops, and
/// with it the object's readings at all stops. Only these are kept, and a coarse grid of all
/// readings.
class TurnReader {
 public:
  TurnReader(const CalibrationTurn& turn, int threads);

  /// Finds the plane from a few stops.
  /// @return nothing if no nearly level plane has any support
  /// @throws std::invalid_argument  if a depth image has another size than the intrinsics say
  const std::optional<PlatformPlane>& find_platform();

  /// Reads the object at all stops, and fits the plane to all of them. `find_platform` must have
  /// found a plane. @throws  as `find_platform`
  TurnViews read_views();

  const PlatformPlane& plane() const { return *plane_; }
  const PlatformSamples& samples() const { return samples_; }

 private:
  const CalibrationTurn& turn_;
  int threads_;
  PlatformSamples samples_;
  std::vector<std::optional<DepthFrame>> kept_;  // of the stops that the plane was found from
  std::optional<PlatformPlane> plane_ = {};
};

}  // namespace octurn
