#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "depth/back_project.hpp"

namespace octurn {

namespace detail {

/// Whether a and b are at most sqrt(threshold) apart; never so if one of them is `no_point`.
inline bool near(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float threshold) {
  const float x = a.x() - b.x();
  const float y = a.y() - b.y();
  const float z = a.z() - b.z();
  return x * x + y * y + z * z <= threshold;
}

}  // namespace detail

/// Joins neighbouring samples to triangles: (i, i+1, i+w) and (i+1, i+w+1, i+w) for each sample i
/// except those of the last row and column (Bennett 2014). A triangle is dropped if a corner is
/// `no_point`, or if a squared side exceeds `threshold`: it would bridge a depth discontinuity.
///
/// @param threshold  square metres
/// @param sink  called with the three corners of each triangle, row by row
template <typename Sink>
void triangulate(const PointGrid& grid, float threshold, Sink sink) {
  const auto width = static_cast<std::size_t>(grid.width);
  const auto height = static_cast<std::size_t>(grid.height);
  for (std::size_t v = 0; v + 1 < height; ++v) {
    const Eigen::Vector3f* upper = grid.points.data() + v * width;
    const Eigen::Vector3f* lower = upper + width;
    for (std::size_t u = 0; u + 1 < width; ++u) {
      // The diagonal is a side of both triangles.
      if (!detail::near(upper[u + 1], lower[u], threshold)) {
        continue;
      }
      if (detail::near(upper[u], upper[u + 1], threshold) &&
          detail::near(lower[u], upper[u], threshold)) {
        sink(upper[u], upper[u + 1], lower[u]);
      }
      if (detail::near(upper[u + 1], lower[u + 1], threshold) &&
          detail::near(lower[u + 1], lower[u], threshold)) {
        sink(upper[u + 1], lower[u + 1], lower[u]);
      }
    }
  }
}

/// The triangles of a mesh whose corners are points and whose sides, squared, are at most
/// `threshold`.
template <typename Sink>
void for_each_triangle(std::span<const Eigen::Vector3f> points,
                       std::span<const LineStrip::Triangle> triangles, float threshold, Sink sink) {
  for (const LineStrip::Triangle& triangle : triangles) {
    const Eigen::Vector3f& a = points[triangle[0]];
    const Eigen::Vector3f& b = points[triangle[1]];
    const Eigen::Vector3f& c = points[triangle[2]];
    if (detail::near(a, b, threshold) && detail::near(b, c, threshold) &&
        detail::near(c, a, threshold)) {
      sink(a, b, c);
    }
  }
}

}  // namespace octurn
