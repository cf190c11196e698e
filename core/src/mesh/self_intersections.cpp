#include "mesh/self_intersections.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "mesh/bvh4.hpp"
#include "mesh/triangle_adjacency.hpp"

namespace octurn {
namespace {

constexpr double clear_sine = 1e-3;  // of angles that no rounding can hide
constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

/// The other ends of the two spokes between which a triangle lies.
struct Spokes {
  std::uint32_t first;
  std::uint32_t second;
};

Spokes find_spokes(const MeshTriangle& triangle, std::uint32_t centre) {
  const std::size_t at = local_index(triangle, centre);
  return {triangle[(at + 1) % 3], triangle[(at + 2) % 3]};
}

/// How often sectors wind round their vertex seen from `up`, counted where they cross a ray; 0 if
/// one may be turned over.
int winding_number(std::span<const Sector> sectors, const Vector3& up) {
  const Vector3 across = cross(up, sectors.front().first);
  const double slack = clear_sine * clear_sine * dot(up, up);
  int turns = 0;
  for (const Sector& sector : sectors) {
    const double above = dot(sector.normal, up);
    const double sides = dot(sector.first, sector.first) * dot(sector.second, sector.second);
    if (!(above > 0 && above * above > slack * sides)) {
      return 0;
    }
    turns += dot(across, sector.first) < 0 && dot(across, sector.second) >= 0 ? 1 : 0;
  }
  return turns;
}

/// Looks at the fans of single vertices, one after the other.
class FanCheck {
 public:
  FanCheck(std::span<const std::array<float, 3>> vertices, std::span<const MeshTriangle> triangles,
           const TriangleAdjacency& adjacency)
      : vertices_(vertices),
        triangles_(triangles),
        adjacency_(adjacency),
        left_from_(vertices.size(), none) {}

  bool is_star_shaped(std::uint32_t vertex) {
    const std::span<const std::uint32_t> fan = adjacency_.triangles_at(vertex);
    const Vector3 centre = to_vector3(vertices_[vertex]);
    bool is_closed = !fan.empty();
    Vector3 up{};
    sectors_.clear();
    for (const std::uint32_t i : fan) {
      const auto [first, second] = find_spokes(triangles_[i], vertex);
      is_closed = is_closed && left_from_[first] != vertex;
      left_from_[first] = vertex;
      sectors_.push_back({.first = to_vector3(vertices_[first]) - centre,
                          .second = to_vector3(vertices_[second]) - centre});
      for (std::size_t axis = 0; axis < 3; ++axis) {
        up[axis] += sectors_.back().normal[axis];
      }
    }
    for (const std::uint32_t i : fan) {
      std::uint32_t& left = left_from_[find_spokes(triangles_[i], vertex).second];
      is_closed = is_closed && left == vertex;
      left = none;
    }
    return is_closed && winding_number(sectors_, up) == 1;
  }

 private:
  std::span<const std::array<float, 3>> vertices_;
  std::span<const MeshTriangle> triangles_;
  const TriangleAdjacency& adjacency_;
  std::vector<std::uint32_t> left_from_;  // by spoke's end: the centre
  std::vector<Sector> sectors_ = {};
};

/// Finds the vertices whose triangles provably meet only in the spokes that they share, so that no
/// pair of those triangles has to be tested.
///
/// Proof. Project the fan of a vertex along the sum of its normals. No triangle is turned over, and
/// each spoke is left by exactly one triangle and met by exactly one other; so the fan winds round
/// the vertex in full turns. If its winding number is 1, the projections are sectors that do not
/// overlap: the fan is star-shaped. What is disjoint in projection is disjoint.
///
/// Conservative: 0 if rounding could matter. O(vertices + triangles).
///
/// @param vertices  positions, millimetres
/// @returns one per vertex: 1 if its fan is star-shaped, otherwise 0
std::vector<char> find_star_shaped_fans(std::span<const std::array<float, 3>> vertices,
                                        std::span<const MeshTriangle> triangles, ThreadTeam& team) {
  const TriangleAdjacency adjacency(triangles, vertices.size(), team);
  std::vector<char> is_star_shaped(vertices.size(), 0);
  team.run([&](int thread) {
    FanCheck check(vertices, triangles, adjacency);
    const auto [first, end] = team.share(vertices.size(), thread);
    for (std::size_t vertex = first; vertex < end; ++vertex) {
      is_star_shaped[vertex] = check.is_star_shaped(static_cast<std::uint32_t>(vertex)) ? 1 : 0;
    }
  });
  return is_star_shaped;
}

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

namespace {

using Corners = std::array<Vector3, 3>;

constexpr double min_gap_mm = 1e-7;
constexpr double min_sine = 1e-9;

double square(double a) { return a * a; }

/// Whether a plane across `axis` separates two triangles.
bool is_separating(const Vector3& axis, const Corners& a, const Corners& b) {
  const std::array along_a{dot(axis, a[0]), dot(axis, a[1]), dot(axis, a[2])};
  const std::array along_b{dot(axis, b[0]), dot(axis, b[1]), dot(axis, b[2])};
  const auto [min_a, max_a] = std::ranges::minmax(along_a);
  const auto [min_b, max_b] = std::ranges::minmax(along_b);
  const double gap = std::max(min_b - max_a, min_a - max_b);
  return gap > 0 && square(gap) > square(min_gap_mm) * dot(axis, axis);
}

/// Triangles without a common vertex, by the separating axis theorem: if any axis separates them,
/// one of these does (Gottschalk, Lin and Manocha 1996).
bool are_disjoint(const Corners& a, const Corners& b) {
  const std::array sides_a{a[1] - a[0], a[2] - a[1], a[0] - a[2]};
  const std::array sides_b{b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vector3 normal_a = cross(sides_a[0], sides_a[1]);
  const Vector3 normal_b = cross(sides_b[0], sides_b[1]);
  if (is_separating(normal_a, a, b) || is_separating(normal_b, a, b)) {
    return true;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (is_separating(cross(normal_a, sides_a[i]), a, b) ||
        is_separating(cross(normal_b, sides_b[i]), a, b)) {
      return true;
    }
  }
  return std::ranges::any_of(sides_a, [&](const Vector3& side_a) {
    return std::ranges::any_of(
        sides_b, [&](const Vector3& side_b) { return is_separating(cross(side_a, side_b), a, b); });
  });
}

/// Whether both sides of a sector leave the plane of another on the same side.
bool is_on_one_side(const Sector& plane, const Sector& sector) {
  const double first = dot(plane.normal, sector.first);
  const double second = dot(plane.normal, sector.second);
  const double slack = square(min_sine) * dot(plane.normal, plane.normal);
  return (first > 0) == (second > 0) && square(first) > slack * dot(sector.first, sector.first) &&
         square(second) > slack * dot(sector.second, sector.second);
}

/// Whether a direction in a sector's plane lies between its sides, or on one.
bool contains(const Sector& sector, const Vector3& direction) {
  const double slack =
      square(min_sine) * dot(direction, direction) * dot(sector.normal, sector.normal);
  const double after_first = dot(cross(sector.first, direction), sector.normal);
  const double before_second = dot(cross(direction, sector.second), sector.normal);
  return (after_first >= 0 || square(after_first) < slack * dot(sector.first, sector.first)) &&
         (before_second >= 0 || square(before_second) < slack * dot(sector.second, sector.second));
}

/// Triangles with one common vertex: they meet elsewhere exactly if their sectors share a
/// direction, as what they share of it near the vertex lies in both.
bool are_disjoint(const Sector& a, const Sector& b) {
  if (is_on_one_side(a, b) || is_on_one_side(b, a)) {
    return true;
  }
  const Vector3 line = cross(a.normal, b.normal);  // of both planes
  if (dot(line, line) < square(min_sine) * dot(a.normal, a.normal) * dot(b.normal, b.normal)) {
    return !contains(a, b.first) && !contains(a, b.second) && !contains(b, a.first) &&
           !contains(b, a.second);
  }
  const Vector3 opposite{-line[0], -line[1], -line[2]};
  return !(contains(a, line) && contains(b, line)) &&
         !(contains(a, opposite) && contains(b, opposite));
}

/// Triangles with a common side: they meet elsewhere exactly if one is folded onto the other.
bool are_disjoint(const Vector3& side, const Vector3& to_a, const Vector3& to_b) {
  const Vector3 a = cross(side, to_a);
  const Vector3 b = cross(side, to_b);
  const Vector3 turn = cross(a, b);
  return dot(a, b) < 0 || dot(turn, turn) > square(min_sine) * dot(a, a) * dot(b, b);
}

}  // namespace

bool are_disjoint(std::span<const std::array<float, 3>> vertices, const MeshTriangle& a,
                  const MeshTriangle& b) {
  // Common vertices come first, in the order of the first triangle.
  MeshTriangle one = a;
  MeshTriangle other = b;
  std::size_t common = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto found =
        std::find(other.begin() + static_cast<std::ptrdiff_t>(common), other.end(), one[i]);
    if (found != other.end()) {
      std::swap(*found, other[common]);
      std::swap(one[i], one[common]);
      ++common;
    }
  }
  const auto corners = [&](const MeshTriangle& triangle) {
    return Corners{to_vector3(vertices[triangle[0]]), to_vector3(vertices[triangle[1]]),
                   to_vector3(vertices[triangle[2]])};
  };
  const Corners p = corners(one);
  const Corners q = corners(other);
  switch (common) {
    case 0:
      return are_disjoint(p, q);
    case 1:
      return are_disjoint(Sector{.first = p[1] - p[0], .second = p[2] - p[0]},
                          Sector{.first = q[1] - p[0], .second = q[2] - p[0]});
    case 2:
      return are_disjoint(p[1] - p[0], p[2] - p[0], q[2] - p[0]);
    default:
      return false;
  }
}

}  // namespace octurn
