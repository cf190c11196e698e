#include "capture/coverage.hpp"

#include <algorithm>
#include <cstdint>

#include "octurn/error.hpp"

namespace octurn {
namespace {

constexpr double min_coverage = 0.6;  // of the readings at the first stop

}  // namespace

std::ptrdiff_t readings_in(const DepthFrame& frame) {
  return std::ranges::count_if(frame.depth, [](std::uint16_t depth) { return depth > 0; });
}

void expect_coverage(std::ptrdiff_t readings, std::ptrdiff_t first, const std::string& sensor) {
  if (readings == 0 || static_cast<double>(readings) < min_coverage * static_cast<double>(first)) {
    throw Error(ErrorCode::sensor_blind,
                sensor + ": has " + std::to_string(readings) +
                    " readings in its picture, and had " + std::to_string(first) +
                    " at the first stop",
                "Look for something before its lenses, and for sunlight.");
  }
}

}  // namespace octurn
