#include "tsdf/marching_cubes_cases.hpp"

#include <algorithm>
#include <bit>
#include <utility>
#include <vector>

namespace octurn {
namespace {

using Corner = int;  // bit 0: x, bit 1: y, bit 2: z
using Loop = std::vector<CubeEdge>;

constexpr std::size_t edges = 12;

/// The edge between two corners that differ on one axis.
CubeEdge edge_between(Corner a, Corner b) {
  const int axis = std::countr_zero(static_cast<unsigned>(a ^ b));
  const int u = a >> (axis + 1) % 3 & 1;
  const int v = a >> (axis + 2) % 3 & 1;
  return static_cast<CubeEdge>(axis * 4 + u + 2 * v);
}

/// The corners of a face, counter-clockwise seen from outside.
/// @param side  0 at the lower, 1 at the upper end of the axis
std::array<Corner, 4> corners_of_face(int axis, int side) {
  const Corner u = 1 << (axis + 1) % 3;
  const Corner v = 1 << (axis + 2) % 3;
  const Corner at = side << axis;
  return side == 1 ? std::array{at, at + u, at + u + v, at + v}
                   : std::array{at, at + v, at + u + v, at + u};
}

/// Where the surface goes on after each edge, by the rule for the signs on a face.
std::array<int, edges> successors(std::size_t pattern) {
  std::array<int, edges> next{};
  next.fill(-1);
  const auto inside = [&](Corner corner) { return (pattern >> corner & 1) != 0; };
  for (int face = 0; face < 6; ++face) {
    const std::array<Corner, 4> corners = corners_of_face(face / 2, face % 2);
    for (std::size_t i = 0; i < 4; ++i) {
      if (inside(corners[i]) || !inside(corners[(i + 1) % 4])) {
        continue;
      }
      // A run of inside corners begins: from where it is entered to where it is left.
      std::size_t last = (i + 1) % 4;
      while (inside(corners[(last + 1) % 4])) {
        last = (last + 1) % 4;
      }
      const CubeEdge enters = edge_between(corners[i], corners[(i + 1) % 4]);
      next[enters] = edge_between(corners[last], corners[(last + 1) % 4]);
    }
  }
  return next;
}

bool share_face(CubeEdge a, CubeEdge b) {
  const auto faces = [](CubeEdge edge) {
    const int axis = edge / 4;
    const int u = (axis + 1) % 3 * 2 + edge % 2;
    const int v = (axis + 2) % 3 * 2 + edge / 2 % 2;
    return 1 << u | 1 << v;
  };
  return (faces(a) & faces(b)) != 0;
}

/// Triangulates a loop by chords of which none lies in a face. @return false if there are none such
bool triangulate_loop(const Loop& loop, CubeSurface& surface) {
  if (loop.size() == 3) {
    surface.triangles[surface.count++] = {loop[0], loop[1], loop[2]};
    return true;
  }
  const std::size_t had = surface.count;
  // Chooses the triangle on the side from the last point to the first, then triangulates the loops
  // on its two other sides.
  const auto is_side_or_free = [&](std::size_t a, std::size_t b) {
    return b - a == 1 || b - a == loop.size() - 1 || !share_face(loop[a], loop[b]);
  };
  for (std::size_t apex = 1; apex + 1 < loop.size(); ++apex) {
    if (!is_side_or_free(0, apex) || !is_side_or_free(apex, loop.size() - 1)) {
      continue;
    }
    const auto at = [&](std::size_t i) { return loop.begin() + static_cast<std::ptrdiff_t>(i); };
    surface.triangles[surface.count++] = {loop.front(), loop[apex], loop.back()};
    if ((apex == 1 || triangulate_loop(Loop(at(0), at(apex + 1)), surface)) &&
        (apex + 2 == loop.size() || triangulate_loop(Loop(at(apex), loop.end()), surface))) {
      return true;
    }
    surface.count = had;
  }
  return false;
}

CubeSurface make_surface(std::size_t pattern) {
  CubeSurface surface;
  std::array<int, edges> next = successors(pattern);
  for (std::size_t first = 0; first < edges; ++first) {
    Loop loop;
    for (std::size_t edge = first; next[edge] >= 0;) {
      loop.push_back(static_cast<CubeEdge>(edge));
      edge = static_cast<std::size_t>(std::exchange(next[edge], -1));
    }
    if (!loop.empty()) {
      triangulate_loop(loop, surface);
    }
  }
  return surface;
}

std::array<CubeSurface, 256> all_patterns() {
  std::array<CubeSurface, 256> surfaces{};
  for (std::size_t pattern = 0; pattern < surfaces.size(); ++pattern) {
    surfaces[pattern] = make_surface(pattern);
  }
  return surfaces;
}

}  // namespace

const std::array<CubeSurface, 256> marching_cubes_cases = all_patterns();

bool is_self_intersecting_case(std::size_t pattern) { return pattern == 229 || pattern == 230; }

}  // namespace octurn
