#pragma once

#include <optional>
#include <span>
#include <vector>

#include "capture/platform_swing.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

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

/// Below this sharpness an object looks the same from all sides.
inline constexpr double min_sharpness = 0.08;

/// Measures the platform's rotation between two depth frames: transforms the points of each into
/// the other, and minimizes the misfit of depths.
///
/// @return nothing if either frame shows too little of an object
std::optional<SeenRotation> seen_rotation(const PlatformLook& view, const DepthFrame& from,
                                          const DepthFrame& to, const AngleRange& range);

/// The misfit of two depth frames for each of some rotations, from 0 to 1. It takes a fraction of
/// the time of `seen_rotation`.
/// @param degs  counter-clockwise seen from above
/// @return empty if either frame shows too little of an object
std::vector<double> misfits_at(const PlatformLook& view, const DepthFrame& from,
                               const DepthFrame& to, std::span<const double> degs);

/// As `misfits_at`, for rotations about the upright axis that fits best: a pose that is some
/// centimetres off then favours no rotation. Each takes some twenty times as long.
std::vector<double> misfits_about_any_axis(const PlatformLook& view, const DepthFrame& from,
                                           const DepthFrame& to, std::span<const double> degs);

}  // namespace octurn
