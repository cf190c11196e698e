#include "simulator/disparity.hpp"

#include <cmath>

namespace octurn {

std::vector<std::uint16_t> depth_of_readings() {
  constexpr double nearest = 4500;    // tenths of a millimetre; real frames begin at 464 mm
  constexpr double farthest = 65534;  // recordings lose the largest value, 65535
  std::vector<std::uint16_t> depths(no_reading + 1, 0);
  for (int reading = 0; reading < no_reading; ++reading) {
    const double depth = 1e4 * static_cast<double>(readings_times_metres) /
                         (static_cast<double>(reading_at_infinity) - reading);
    if (depth >= nearest && depth <= farthest) {
      depths[static_cast<std::size_t>(reading)] = static_cast<std::uint16_t>(std::lround(depth));
    }
  }
  return depths;
}

}  // namespace octurn
