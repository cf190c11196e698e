#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>

#include "octurn/snapshot.hpp"

namespace octurn {

/// Metres: closer than the range of any depth sensor.
inline constexpr double nearest_z = 0.05;

/// @throws std::invalid_argument  if the frame's size is not that of the intrinsics
inline void check_size(const DepthFrame& frame, const Intrinsics& intrinsics, const char* who) {
  const auto samples =
      static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height);
  if (frame.width != intrinsics.width || frame.height != intrinsics.height ||
      frame.depth.size() != samples) {
    throw std::invalid_argument(std::string(who) +
                                ": the frame's size is not that of the intrinsics");
  }
}

}  // namespace octurn
