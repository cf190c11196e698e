#include "simulator/surface.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/camera.hpp"

namespace octurn {
namespace {

/// The slope of inverse depth between a pixel and its neighbours along one axis, 1/m for each
/// pixel. A neighbour that belongs to another surface does not count.
float slope(float before, float here, float after) {
  const bool starts_here = is_edge(before, here);
  const bool ends_here = is_edge(here, after);
  if (starts_here && ends_here) {
    return 0;
  }
  return starts_here ? after - here : ends_here ? here - before : (after - before) / 2;
}

}  // namespace

bool is_edge(float a, float b) {
  constexpr float share = 0.015F;
  return std::abs(a - b) > share * std::max(a, b);
}

Surface surface_at(const InverseDepth& picture, int u, int v) {
  const auto at = [&picture](int column, int row) {
    const int inside_u = std::clamp(column, 0, camera.width - 1);
    const int inside_v = std::clamp(row, 0, camera.height - 1);
    return picture[static_cast<std::size_t>(inside_v * camera.width + inside_u)];
  };
  const float here = at(u, v);
  const float left = at(u - 1, v);
  const float right = at(u + 1, v);
  const float above = at(u, v - 1);
  const float below = at(u, v + 1);
  // A plane n . p = 1 has inverse depth n . r along the ray r = ((u - cx) / f, (v - cy) / f, 1), so
  // the slopes of the inverse depth give n.
  constexpr auto focal = static_cast<float>(camera.fx);
  const float x = (static_cast<float>(u) - static_cast<float>(camera.cx)) / focal;
  const float y = (static_cast<float>(v) - static_cast<float>(camera.cy)) / focal;
  const float nx = focal * slope(left, here, right);
  const float ny = focal * slope(above, here, below);
  const float nz = here - x * nx - y * ny;
  const float squares = (x * x + y * y + 1) * (nx * nx + ny * ny + nz * nz);
  return {.inverse_depth = here,
          .cosine = here / std::sqrt(squares),
          .is_edge = is_edge(here, left) || is_edge(here, right) || is_edge(here, above) ||
                     is_edge(here, below)};
}

}  // namespace octurn
