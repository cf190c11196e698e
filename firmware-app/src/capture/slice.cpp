#include "capture/slice.hpp"

#include <cmath>

namespace octurn {
namespace {

// Bounds of a slice, metres: the space above the platform.
constexpr double half_thickness = 0.001;
constexpr double radius = 0.17;
constexpr double bottom = -0.02;
constexpr double top = 0.4;
constexpr std::size_t max_points = 3000;  // enough for a picture of some hundred pixels

}  // namespace

void add_to_slice(Slice& slice, const Eigen::Vector3d& point) {
  if (std::abs(point.y()) <= half_thickness && std::abs(point.x()) <= radius &&
      point.z() >= bottom && point.z() <= top) {
    slice.emplace_back(point.x(), point.z());
  }
}

Slice thinned(const Slice& slice) {
  const std::size_t step = slice.size() / max_points + 1;
  Slice some;
  for (std::size_t i = 0; i < slice.size(); i += step) {
    some.push_back(slice[i]);
  }
  return some;
}

}  // namespace octurn
