#include "mesh/self_intersections.hpp"

#include <cstdint>
#include <utility>

#include "mesh/bvh4.hpp"
#include "mesh/star_shaped_fans.hpp"
#include "mesh/triangle_overlap.hpp"

namespace octurn {
namespace {

Aabb to_aabb(const MeshTriangle& triangle, std::span<const std::array<float, 3>> vertices) {
  const auto& [a, b, c] = triangle;
  Aabb box{.min = vertices[a], .max = vertices[a]};
  box.extend({vertices[b], vertices[b]});
  box.extend({vertices[c], vertices[c]});
  return box;
}

/// Whether two triangles lie in the star-shaped fan of a vertex that they share. Without branches,
/// as most tested pairs are neighbours.
bool share_star_shaped_fan(const MeshTriangle& a, const MeshTriangle& b,
                           std::span<const char> is_star_shaped) {
  int any = 0;
  for (const std::uint32_t corner : a) {
    const int is_common =
        (corner == b[0] ? 1 : 0) | (corner == b[1] ? 1 : 0) | (corner == b[2] ? 1 : 0);
    any |= is_common & is_star_shaped[corner];
  }
  return any != 0;
}

}  // namespace

std::vector<Aabb> self_intersections(std::span<const std::array<float, 3>> vertices,
                                     std::span<const MeshTriangle> triangles,
                                     std::size_t already_checked, ThreadTeam& team) {
  const std::vector<char> is_star_shaped = find_star_shaped_fans(vertices, triangles, team);
  const auto bounds = [&](std::uint32_t i) { return to_aabb(triangles[i], vertices); };
  const Bvh4 bvh(triangles.size(), bounds, team);
  std::vector<std::vector<Aabb>> found(static_cast<std::size_t>(team.size()));
  bvh.for_each_overlapping_pair(team, [&](int thread, std::uint32_t a, std::uint32_t b) {
    if (!share_star_shaped_fan(triangles[a], triangles[b], is_star_shaped) &&
        (a >= already_checked || b >= already_checked) &&
        !are_disjoint(vertices, triangles[a], triangles[b])) {
      found[static_cast<std::size_t>(thread)].insert(found[static_cast<std::size_t>(thread)].end(),
                                                     {bounds(a), bounds(b)});
    }
  });
  for (std::size_t i = 1; i < found.size(); ++i) {
    found[0].insert(found[0].end(), found[i].begin(), found[i].end());
  }
  return std::move(found[0]);
}

}  // namespace octurn
