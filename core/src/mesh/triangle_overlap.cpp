#include "mesh/triangle_overlap.hpp"

#include <algorithm>

namespace octurn {
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
