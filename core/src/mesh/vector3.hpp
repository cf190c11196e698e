#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace octurn {

/// Vectors whose operations round in one fixed order, so that models are bit-equal on every
/// processor.
///
/// Not Eigen's vectors: the order of Eigen's sums depends on the length and on the processor's
/// vector units. `Number` may be an Eigen array, which evaluates several vectors at once.
using Vector3 = std::array<double, 3>;

inline Vector3 to_vector3(const std::array<float, 3>& position) {
  return {static_cast<double>(position[0]), static_cast<double>(position[1]),
          static_cast<double>(position[2])};
}

template <typename Number>
std::array<Number, 3> operator-(const std::array<Number, 3>& a, const std::array<Number, 3>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

template <typename Number>
std::array<Number, 3> cross(const std::array<Number, 3>& a, const std::array<Number, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <typename Number>
Number dot(const std::array<Number, 3>& a, const std::array<Number, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Normal of a triangle with counter-clockwise corners; its length is twice the area.
inline Vector3 area_normal(const Vector3& a, const Vector3& b, const Vector3& c) {
  return cross(b - a, c - a);
}

/// Axis-aligned bounding box, millimetres; closed.
struct Aabb {
  std::array<float, 3> min = {};
  std::array<float, 3> max = {};

  void extend(const Aabb& other) {
    for (std::size_t i = 0; i < 3; ++i) {
      min[i] = std::min(min[i], other.min[i]);
      max[i] = std::max(max[i], other.max[i]);
    }
  }

  /// Whether the boxes have a point in common.
  bool overlaps(const Aabb& other) const {
    return min[0] <= other.max[0] && other.min[0] <= max[0] && min[1] <= other.max[1] &&
           other.min[1] <= max[1] && min[2] <= other.max[2] && other.min[2] <= max[2];
  }
};

}  // namespace octurn
