#pragma once

#include <cstddef>
#include <stdexcept>

#include "octurn/reconstruct.hpp"

namespace octurn {

/// Returns the object's placement in a snapshot of one of several poses.
/// @throws std::invalid_argument  if the options do not list it
inline const Placement& find_placement(const Snapshot& snapshot,
                                       const ReconstructOptions& options) {
  const auto pose = static_cast<std::size_t>(snapshot.pose);
  if (snapshot.pose < 0 || pose >= options.placements.size()) {
    throw std::invalid_argument("reconstruct: a snapshot is of a pose that is not listed");
  }
  return options.placements[pose];
}

}  // namespace octurn
