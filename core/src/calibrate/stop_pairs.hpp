#pragma once

#include <cstddef>
#include <vector>

namespace octurn {

/// Two stops whose views of the object are compared: readings of `from` with the surface of `to`.
struct StopPair {
  std::size_t from = 0;
  std::size_t to = 0;
};

/// Both directions of the pairs of stops that are about 15, 30, 45 or 75 degrees apart, of few
/// stops also 90; where there are none, of neighbours that are less than 100 degrees apart. In the
/// order of `from`.
/// @param angles  of the stops, radians
std::vector<StopPair> make_stop_pairs(const std::vector<double>& angles);

}  // namespace octurn
