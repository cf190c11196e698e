#pragma once

#include <cstddef>
#include <vector>

namespace octurn {

/// Two stops whose views of the object are compared: readings of `from` with the surface of `to`.
struct StopPair {
  std::size_t from = 0;
  std::size_t to = 0;
};

/// Stops up to this far apart are compared where no others are at the preferred angles.
inline constexpr double max_neighbour_deg = 100;

/// Both directions of the pairs of stops that are about 15, 30, 45 or 75 degrees apart, with few
/// stops also 90; if there are none, neighbours less than 100 degrees apart. Sorted by `from`.
/// @param angles  of the stops, radians
std::vector<StopPair> make_stop_pairs(const std::vector<double>& angles);

}  // namespace octurn
