#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace octurn {

/// A corner of a triangle in the image of a pinhole camera.
struct ImageCorner {
  double u = 0;  ///< pixels
  double v = 0;
  double inverse_depth = 0;  ///< 1 / metres; linear in the image on a plane
};

/// Rasterises a triangle of either orientation: calls `visit(u, v, shares)` for each pixel whose
/// centre lies in it, with its barycentric coordinates.
template <class Visit>
void visit_pixels(const std::array<ImageCorner, 3>& c, int width, int height, const Visit& visit) {
  // In barycentric coordinates; and twice the area of a degenerate triangle, pixels^2.
  constexpr double slack = 1e-6;
  const double area = (c[1].u - c[0].u) * (c[2].v - c[0].v) - (c[2].u - c[0].u) * (c[1].v - c[0].v);
  if (std::abs(area) < slack) {
    return;
  }
  const auto [u0, u1] = std::minmax({c[0].u, c[1].u, c[2].u});
  const auto [v0, v1] = std::minmax({c[0].v, c[1].v, c[2].v});
  // Clamped on both sides before the conversion: a corner may be projected beyond the range of int.
  const auto first = [](double min, int size) {
    return static_cast<int>(std::ceil(std::clamp(min, 0.0, static_cast<double>(size))));
  };
  const auto last = [](double max, int size) {
    return static_cast<int>(std::clamp(max, -1.0, size - 1.0));
  };
  const int left = first(u0, width);
  const int right = last(u1, width);
  const int bottom = last(v1, height);
  for (int v = first(v0, height); v <= bottom; ++v) {
    for (int u = left; u <= right; ++u) {
      const double b = ((u - c[0].u) * (c[2].v - c[0].v) - (c[2].u - c[0].u) * (v - c[0].v)) / area;
      const double d = ((c[1].u - c[0].u) * (v - c[0].v) - (u - c[0].u) * (c[1].v - c[0].v)) / area;
      const double a = 1 - b - d;
      if (a >= -slack && b >= -slack && d >= -slack) {
        visit(u, v, std::array<double, 3>{a, b, d});
      }
    }
  }
}

/// Interpolates the inverse depth in a triangle, 1 / metres. @param shares  barycentric coordinates
inline double inverse_depth_at(const std::array<ImageCorner, 3>& corners,
                               const std::array<double, 3>& shares) {
  return shares[0] * corners[0].inverse_depth + shares[1] * corners[1].inverse_depth +
         shares[2] * corners[2].inverse_depth;
}

}  // namespace octurn
