#pragma once

#include <Eigen/Geometry>
#include <optional>

#include "octurn/snapshot.hpp"

namespace octurn {

/// What a sensor on a rig sees of the object, and from where.
struct View {
  Intrinsics intrinsics = {};
  Eigen::Isometry3d platform_from_sensor = {};  ///< metres; need be right to some millimetres only
  Box clip = {};                                ///< around the object, platform frame, metres
};

/// Where a rotation is searched for, degrees counter-clockwise seen from above.
struct AngleRange {
  double min_deg = 0;
  double max_deg = 0;
};

/// The rotation about the platform's axis between two looks at the same object.
struct SeenRotation {
  double deg = 0;  ///< counter-clockwise seen from above
  /// How much worse the looks agree four degrees beside it, as a share of how well they agree at
  /// it. An object that looks the same from all sides has 0.
  double sharpness = 0;
};

/// Measures how the platform turned from one look to another, by turning the readings of each to
/// the other and comparing depths.
///
/// @return nothing if either look sees too little of an object
std::optional<SeenRotation> seen_rotation(const View& view, const DepthFrame& from,
                                          const DepthFrame& to, const AngleRange& range);

}  // namespace octurn
