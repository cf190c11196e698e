#pragma once

#include <cstddef>

#include "octurn/snapshot.hpp"

namespace octurn {

/// Intrinsics of the simulated Kinect.
inline constexpr Intrinsics camera = {};

constexpr std::size_t pixels(const Intrinsics& intrinsics) {
  return static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height);
}

}  // namespace octurn
