#include "bennett/voxelize_triangle.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>

namespace octurn {
namespace {

using Int64 = std::int64_t;

// Corners reach from -2^19 to 2^20 half-units, an edge's halved components 1.5 * 2^19, a normal's
// 2 * (1.5 * 2^19)^2 < 2^41, and a plane's value at a box near it 3 * 2^41 * 1.5 * 2^20 < 2^63.

/// Leaves along one axis, both ends included.
struct Range {
  int low = 0;
  int high = -1;
  bool empty() const { return low > high; }
};

Range common(const Range& a, const Range& b) {
  return {std::max(a.low, b.low), std::min(a.high, b.high)};
}

using Ranges = std::array<Range, 3>;

/// An axis and the two that follow it, which span the plane across it.
struct Axes {
  std::size_t w = 0;
  std::size_t u = 1;
  std::size_t v = 2;
};

constexpr std::array<Axes, 3> all_axes{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};

/// A triangle's shadow across an axis, as three half-planes that a leaf's shadow must reach into:
/// normal_u u + normal_v v + offset >= 0, for the leaf at (u, v), counted in leaves.
struct Projection2d {
  struct Edge {
    Int64 normal_u = 0;
    Int64 normal_v = 0;
    Int64 offset = 0;
  };
  std::array<Edge, 3> edges = {};

  bool meets(int u, int v) const {
    const auto reached = [&](const Edge& edge) {
      return edge.normal_u * u + edge.normal_v * v + edge.offset;
    };
    return (reached(edges[0]) | reached(edges[1]) | reached(edges[2])) >= 0;  // no sign bit is set
  }
};

struct Triangle {
  std::array<SnapPoint, 3> corners = {};
  int leaf_bits = 0;
  std::array<std::array<std::int32_t, 3>, 3> edges =
      {};  // halved: differences of odd corners are even
  std::array<Int64, 3> normal = {};

  Triangle(const SnapPoint& a, const SnapPoint& b, const SnapPoint& c, int bits)
      : corners{a, b, c}, leaf_bits(bits) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      edges[0][axis] = (b[axis] - a[axis]) / 2;
      edges[1][axis] = (c[axis] - b[axis]) / 2;
      edges[2][axis] = (a[axis] - c[axis]) / 2;
    }
    for (const Axes& axes : all_axes) {
      normal[axes.w] =
          Int64{edges[0][axes.u]} * edges[1][axes.v] - Int64{edges[0][axes.v]} * edges[1][axes.u];
    }
  }

  Int64 leaf() const { return Int64{1} << leaf_bits; }

  Projection2d shadow(const Axes& axes) const {
    const Int64 sign = normal[axes.w] < 0 ? -1 : 1;
    Projection2d shadow;
    for (std::size_t i = 0; i < 3; ++i) {
      const Int64 normal_u = -edges[i][axes.v] * sign;
      const Int64 normal_v = edges[i][axes.u] * sign;
      const Int64 reach = (std::max<Int64>(normal_u, 0) + std::max<Int64>(normal_v, 0))
                          << leaf_bits;
      shadow.edges[i] = {
          .normal_u = normal_u * leaf(),
          .normal_v = normal_v * leaf(),
          .offset = reach - normal_u * corners[i][axes.u] - normal_v * corners[i][axes.v]};
    }
    return shadow;
  }
};

/// The plane of a triangle, cut along the axis that its normal is nearest to.
class Plane {
 public:
  explicit Plane(const Triangle& triangle) {
    const std::array<Int64, 3>& normal = triangle.normal;
    const auto larger = [&](std::size_t a, std::size_t b) {
      return std::abs(normal[b]) > std::abs(normal[a]) ? b : a;
    };
    axes_ = all_axes[larger(larger(0, 1), 2)];
    const Int64 sign = normal[axes_.w] < 0 ? -1 : 1;
    const Int64 normal_u = normal[axes_.u] * sign;
    const Int64 normal_v = normal[axes_.v] * sign;
    const Int64 normal_w = normal[axes_.w] * sign;
    const SnapPoint& corner = triangle.corners[0];
    const Int64 offset =
        normal_u * corner[axes_.u] + normal_v * corner[axes_.v] + normal_w * corner[axes_.w];
    const Int64 leaf = triangle.leaf();
    slope_u_ = normal_u * leaf;
    slope_v_ = normal_v * leaf;
    pitch_ = normal_w * leaf;
    lowest_ = offset - std::max<Int64>(slope_u_, 0) - std::max<Int64>(slope_v_, 0);
    highest_ = offset - std::min<Int64>(slope_u_, 0) - std::min<Int64>(slope_v_, 0);
  }

  const Axes& axes() const { return axes_; }

  /// The leaves of `range` that the plane meets, along `axes().w` in the column (u, v).
  Range column(int u, int v, Range range) const {
    if (pitch_ == 0) {
      return range;  // no area, no plane
    }
    const Int64 slope = slope_u_ * u + slope_v_ * v;
    const Int64 lowest = lowest_ - slope;
    const Int64 highest = highest_ - slope;
    if (range.high - range.low > steps_worth_a_division) {
      range = common(range, {static_cast<int>(-floor_quotient(-lowest, pitch_) - 1),
                             static_cast<int>(floor_quotient(highest, pitch_))});
    }
    while (range.low <= range.high && (range.low + 1) * pitch_ < lowest) {
      ++range.low;
    }
    while (range.low <= range.high && range.high * pitch_ > highest) {
      --range.high;
    }
    return range;
  }

 private:
  static constexpr int steps_worth_a_division = 4;

  static Int64 floor_quotient(Int64 a, Int64 b) { return a / b - (a % b < 0 ? 1 : 0); }

  Axes axes_ = {};
  Int64 slope_u_ = 0;  // of the normal, over one leaf
  Int64 slope_v_ = 0;
  Int64 pitch_ = 0;
  Int64 lowest_ = 0;
  Int64 highest_ = 0;
};

/// All of `box`: right where at most one of its ranges is more than one leaf.
void fill_box(Octree& octree, const Ranges& box) {
  for (int z = box[2].low; z <= box[2].high; ++z) {
    for (int y = box[1].low; y <= box[1].high; ++y) {
      for (int x = box[0].low; x <= box[0].high; ++x) {
        octree.set({x, y, z});
      }
    }
  }
}

/// Where `box` is one leaf thick along `axes.w`, a leaf is met if its shadow along that axis is.
void voxelize_2d(Octree& octree, const Triangle& triangle, const Ranges& box, const Axes& axes) {
  const Projection2d shadow = triangle.shadow(axes);
  std::array<int, 3> leaf{};
  leaf[axes.w] = box[axes.w].low;
  for (leaf[axes.v] = box[axes.v].low; leaf[axes.v] <= box[axes.v].high; ++leaf[axes.v]) {
    for (leaf[axes.u] = box[axes.u].low; leaf[axes.u] <= box[axes.u].high; ++leaf[axes.u]) {
      if (shadow.meets(leaf[axes.u], leaf[axes.v])) {
        octree.set({leaf[0], leaf[1], leaf[2]});
      }
    }
  }
}

void voxelize_3d(Octree& octree, const Triangle& triangle, const Ranges& box) {
  const Plane plane(triangle);
  const Axes axes = plane.axes();
  const Projection2d across_w = triangle.shadow(axes);
  const Projection2d across_u = triangle.shadow(all_axes[axes.u]);  // on the plane of v and w
  const Projection2d across_v = triangle.shadow(all_axes[axes.v]);  // on the plane of w and u
  std::array<int, 3> leaf{};
  for (leaf[axes.v] = box[axes.v].low; leaf[axes.v] <= box[axes.v].high; ++leaf[axes.v]) {
    for (leaf[axes.u] = box[axes.u].low; leaf[axes.u] <= box[axes.u].high; ++leaf[axes.u]) {
      if (!across_w.meets(leaf[axes.u], leaf[axes.v])) {
        continue;
      }
      const Range range = plane.column(leaf[axes.u], leaf[axes.v], box[axes.w]);
      for (leaf[axes.w] = range.low; leaf[axes.w] <= range.high; ++leaf[axes.w]) {
        if (across_u.meets(leaf[axes.v], leaf[axes.w]) &&
            across_v.meets(leaf[axes.w], leaf[axes.u])) {
          octree.set({leaf[0], leaf[1], leaf[2]});
        }
      }
    }
  }
}

}  // namespace

void voxelize_triangle(Octree& octree, const SnapPoint& a, const SnapPoint& b, const SnapPoint& c,
                       const LeafLayers& layers) {
  const int leaf_bits = SnapGrid::bits - octree.levels();
  const int last = octree.leaves_per_side() - 1;
  Ranges box;  // of the leaves in the root and the layers
  std::array<bool, 3> thick{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Range whole{std::min({a[axis], b[axis], c[axis]}) >> leaf_bits,
                      std::max({a[axis], b[axis], c[axis]}) >> leaf_bits};
    thick[axis] = whole.low < whole.high;
    box[axis] = common(whole, {0, last});
  }
  box[2] = common(box[2], {layers.low, layers.high});
  if (box[0].empty() || box[1].empty() || box[2].empty()) {
    return;
  }
  if (thick[0] + thick[1] + thick[2] <= 1) {
    fill_box(octree, box);
    return;
  }
  const Triangle triangle(a, b, c, leaf_bits);
  if (thick[0] && thick[1] && thick[2]) {
    voxelize_3d(octree, triangle, box);
  } else {
    voxelize_2d(octree, triangle, box, all_axes[thick[0] ? (thick[1] ? 2U : 1U) : 0U]);
  }
}

}  // namespace octurn
