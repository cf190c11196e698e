#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "calibrate/platform_plane.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Pixels between readings that the plane is fitted to.
inline constexpr int platform_step = 4;

/// A grid of every fourth pixel in both directions, with its rays and room for the depths of stops.
PlatformSamples make_platform_samples(const Intrinsics& lens, std::size_t stops);

/// The depths of a frame at that grid's pixels, metres along z; 0 is no reading.
/// @throws std::invalid_argument  if the frame has another size than the intrinsics say
std::vector<float> sample_depths(const DepthFrame& frame, const Intrinsics& lens);

}  // namespace octurn
