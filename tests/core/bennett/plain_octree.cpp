#include "core/bennett/plain_octree.hpp"

#include <algorithm>
#include <cstdint>

namespace octurn::plain {
namespace {

using Vector = std::array<std::int64_t, 3>;
__extension__ typedef __int128 Exact;  // NOLINT(modernize-use-using): -Wpedantic

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Exact dot(const Vector& a, const Vector& b) {
  return Exact{a[0]} * b[0] + Exact{a[1]} * b[1] + Exact{a[2]} * b[2];
}

/// Whether the projections of a triangle and a cube onto an axis are disjoint.
bool apart(const Vector& axis, const std::array<Vector, 3>& corners, const Vector& low,
           std::int64_t side) {
  Exact cube_low = 0;
  Exact cube_high = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Exact a = Exact{axis[i]} * low[i];
    const Exact b = Exact{axis[i]} * (low[i] + side);
    cube_low += std::min(a, b);
    cube_high += std::max(a, b);
  }
  const auto [low_corner, high_corner] =
      std::minmax({dot(axis, corners[0]), dot(axis, corners[1]), dot(axis, corners[2])});
  return high_corner < cube_low || low_corner > cube_high;
}

bool meet(const std::array<Vector, 3>& corners, const Vector& low, std::int64_t side) {
  const std::array<Vector, 3> unit{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  std::vector<Vector> axes(unit.begin(), unit.end());
  axes.push_back(cross(minus(corners[1], corners[0]), minus(corners[2], corners[0])));
  for (std::size_t i = 0; i < 3; ++i) {
    for (const Vector& along : unit) {
      axes.push_back(cross(along, minus(corners[(i + 1) % 3], corners[i])));
    }
  }
  return std::ranges::none_of(axes,
                              [&](const Vector& axis) { return apart(axis, corners, low, side); });
}

const std::array<std::array<int, 4>, 6> tetrahedra{
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

/// Orients a triangle so that `inside` (half leaves) lies behind it, and rotates its corners so
/// that the smallest comes first.
Triangle outward(Triangle t, const std::array<int, 3>& inside) {
  const auto v = [](const std::array<int, 3>& p) { return Vector{p[0], p[1], p[2]}; };
  const Vector normal = cross(minus(v(t[1]), v(t[0])), minus(v(t[2]), v(t[0])));
  if (dot(normal, minus(v(t[0]), v(inside))) < 0) {
    std::swap(t[1], t[2]);
  }
  std::rotate(t.begin(), std::ranges::min_element(t), t.end());
  return t;
}

}  // namespace

void Octree::voxelize(const std::array<SnapPoint, 3>& corners) { voxelize(corners, 0, {0, 0, 0}); }

void Octree::voxelize(const std::array<SnapPoint, 3>& corners, int level,
                      const std::array<int, 3>& node) {
  const std::int64_t side = std::int64_t{1} << (SnapGrid::bits - level);
  std::array<Vector, 3> points;
  for (std::size_t i = 0; i < 3; ++i) {
    points[i] = {corners[i][0], corners[i][1], corners[i][2]};
  }
  if (!meet(points, {node[0] * side, node[1] * side, node[2] * side}, side)) {
    return;
  }
  if (level == levels_) {
    leaves_.insert(node);
    return;
  }
  for (int child = 0; child < 8; ++child) {
    voxelize(
        corners, level + 1,
        {2 * node[0] + (child & 1), 2 * node[1] + (child >> 1 & 1), 2 * node[2] + (child >> 2)});
  }
}

std::set<std::array<int, 3>> Octree::nodes(int level) const {
  std::set<std::array<int, 3>> nodes;
  for (const auto& [x, y, z] : leaves_) {
    const int finer = levels_ - level;
    nodes.insert({x >> finer, y >> finer, z >> finer});
  }
  return nodes;
}

std::vector<Triangle> marching_tetrahedra(const std::set<std::array<int, 3>>& leaves) {
  const auto corner = [](const std::array<int, 3>& low, int i) {
    return std::array{low[0] + (i & 1), low[1] + (i >> 1 & 1), low[2] + (i >> 2)};
  };
  std::set<std::array<int, 3>> pseudo_voxels;  // each by the leaf at its lowest corner
  for (const auto& [x, y, z] : leaves) {
    for (int i = 0; i < 8; ++i) {
      pseudo_voxels.insert({x - (i & 1), y - (i >> 1 & 1), z - (i >> 2)});
    }
  }
  std::vector<Triangle> triangles;
  for (const std::array<int, 3>& low : pseudo_voxels) {
    // The leaf at p has its centre at 2 p + 1 half leaves. The middle between the centres of p and
    // q is half their sum, p + q + 1.
    const auto half_way = [&](int a, int b) {
      const std::array<int, 3> p = corner(low, a);
      const std::array<int, 3> q = corner(low, b);
      return std::array{p[0] + q[0] + 1, p[1] + q[1] + 1, p[2] + q[2] + 1};
    };
    for (const std::array<int, 4>& tetrahedron : tetrahedra) {
      std::vector<int> in;
      std::vector<int> out;
      for (const int i : tetrahedron) {
        (leaves.contains(corner(low, i)) ? in : out).push_back(i);
      }
      const auto add = [&](const Triangle& triangle) {
        triangles.push_back(outward(triangle, half_way(in[0], in[0])));
      };
      if (in.size() == 1) {
        add({half_way(in[0], out[0]), half_way(in[0], out[1]), half_way(in[0], out[2])});
      } else if (in.size() == 3) {
        add({half_way(in[0], out[0]), half_way(in[1], out[0]), half_way(in[2], out[0])});
      } else if (in.size() == 2) {
        add({half_way(in[0], out[0]), half_way(in[0], out[1]), half_way(in[1], out[1])});
        add({half_way(in[0], out[0]), half_way(in[1], out[1]), half_way(in[1], out[0])});
      }
    }
  }
  std::ranges::sort(triangles);
  return triangles;
}

}  // namespace octurn::plain
