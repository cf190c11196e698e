#pragma once

#include <cstdint>
#include <vector>

namespace octurn {

/// One image from a depth sensor: width x height values, row by row from the top left, in the
/// sensor's depth unit; 0 is no reading.
struct DepthFrame {
  int width = 0;
  int height = 0;
  std::vector<std::uint16_t> depth = {};
};

}  // namespace octurn
