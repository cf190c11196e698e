#pragma once

#include <array>

namespace octurn {

/// What meshes need of vectors, of numbers or of several at once, always in the same order of
/// operations.
using Vector3 = std::array<double, 3>;

inline Vector3 vector_of(const std::array<float, 3>& position) {
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

inline Vector3 normal_of(const Vector3& a, const Vector3& b, const Vector3& c) {
  return cross(b - a, c - a);
}

}  // namespace octurn
