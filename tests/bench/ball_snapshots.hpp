#pragma once

#include <cstddef>
#include <vector>

#include "support/ball_scan.hpp"

namespace octurn {

inline constexpr std::size_t shots = 8;

/// Snapshots of a ball at the size of a Kinect v1's image.
inline const std::vector<Snapshot>& snapshots() {
  static const std::vector<Snapshot> all = [] {
    std::vector<Snapshot> made;
    for (std::size_t i = 0; i < shots; ++i) {
      made.push_back(ball_snapshot(ball_angle(i, shots), Intrinsics{}));
    }
    return made;
  }();
  return all;
}

inline SnapshotSource source() {
  return {.count = shots, .read = [](std::size_t i) { return snapshots()[i]; }};
}

}  // namespace octurn
