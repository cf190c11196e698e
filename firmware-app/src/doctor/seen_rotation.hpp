#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "octurn/snapshot.hpp"

namespace octurn {

/// Geometry of a sensor that looks at an object on the platform.
struct View {
  Intrinsics intrinsics = {};
  Eigen::Isometry3d platform_from_sensor = {};  ///< metres; errors of some millimetres are allowed
  Box clip = {};                                ///< around the object, platform frame, metres
};

/// Search range of a rotation, in degrees counter-clockwise seen from above.
struct AngleRange {
  double min_deg = 0;
  double max_deg = 0;
};

/// The rotation about the platform's axis between two depth frames of the same object.
struct SeenRotation {
  double deg = 0;  ///< counter-clockwise seen from above
  /// Relative increase of the misfit four degrees beside the rotation. 0 for an object that looks
  /// the same from all sides.
  double sharpness = 0;
};

/// Measures the platform's rotation between two depth frames: transforms the points of each into
/// the other, and minimizes the misfit of depths.
///
/// @return nothing if either frame shows too little of an object
std::optional<SeenRotation> seen_rotation(const View& view, const DepthFrame& from,
                                          const DepthFrame& to, const AngleRange& range);

}  // namespace octurn
