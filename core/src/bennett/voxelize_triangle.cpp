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
struct Interval {
  int min = 0;
  int max = -1;
  bool empty() const { return min > max; }
};

Interval intersection(const Interval& a, const Interval& b) {
  return {std::max(a.min, b.min), std::min(a.max, b.max)};
}

using LeafBox = std::array<Interval, 3>;

/// An axis and the two that follow it, which span the plane across it.
struct Axes {
  std::size_t w = 0;
  std::size_t u = 1;
  std::size_t v = 2;
};

constexpr std::array<Axes, 3> all_axes{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}}};

/// A triangle's projection along an axis, as three half-planes that a leaf's projection must reach
/// into: normal_u u + normal_v v + offset >= 0, for the leaf at (u, v), counted in leaves.
struct Projection2d {
  struct Edge {
    Int64 normal_u = 0;
    Int64 normal_v = 0;
    Int64 offset = 0;
  };
  std::array<Edge, 3> edges = {};

  bool meets(int u, int v) const {
    const auto value = [&](const Edge& edge) {
      return edge.normal_u * u + edge.normal_v * v + edge.offset;
    };
    return (value(edges[0]) | value(edges[1]) | value(edges[2])) >= 0;  // no sign bit is set
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

  Projection2d project(const Axes& axes) const {
    const Int64 sign = normal[axes.w] < 0 ? -1 : 1;
    Projection2d projection;
    for (std::size_t i = 0; i < 3; ++i) {
      const Int64 normal_u = -edges[i][axes.v] * sign;
      const Int64 normal_v = edges[i][axes.u] * sign;
      const Int64 reach = (std::max<Int64>(normal_u, 0) + std::max<Int64>(normal_v, 0))
                          << leaf_bits;
      projection.edges[i] = {
          .normal_u = normal_u * leaf(),
          .normal_v = normal_v * leaf(),
          .offset = reach - normal_u * corners[i][axes.u] - normal_v * corners[i][axes.v]};
    }
    return projection;
  }
};

/// The plane of a triangle, solved for the axis w of its normal's largest component.
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
    step_w_ = normal_w * leaf;
    min_ = offset - std::max<Int64>(slope_u_, 0) - std::max<Int64>(slope_v_, 0);
    max_ = offset - std::min<Int64>(slope_u_, 0) - std::min<Int64>(slope_v_, 0);
  }

  const Axes& axes() const { return axes_; }

  /// The leaves of `interval` that the plane meets, along `axes().w` at (u, v).
  Interval w_interval(int u, int v, Interval interval) const {
    if (step_w_ == 0) {
      return interval;  // a triangle without area has no plane
    }
    const Int64 slope = slope_u_ * u + slope_v_ * v;
    const Int64 min = min_ - slope;
    const Int64 max = max_ - slope;
    if (interval.max - interval.min > steps_worth_a_division) {
      interval = intersection(interval, {static_cast<int>(-floor_quotient(-min, step_w_) - 1),
                                         static_cast<int>(floor_quotient(max, step_w_))});
    }
    while (interval.min <= interval.max && (interval.min + 1) * step_w_ < min) {
      ++interval.min;
    }
    while (interval.min <= interval.max && interval.max * step_w_ > max) {
      --interval.max;
    }
    return interval;
  }

 private:
  static constexpr int steps_worth_a_division = 4;

  static Int64 floor_quotient(Int64 a, Int64 b) { return a / b - (a % b < 0 ? 1 : 0); }

  Axes axes_ = {};
  Int64 slope_u_ = 0;  // the plane's value grows by these from leaf to leaf
  Int64 slope_v_ = 0;
  Int64 step_w_ = 0;
  Int64 min_ = 0;  // of w * step_w_ on the plane, over the leaf at (0, 0)
  Int64 max_ = 0;
};

/// Sets all of `box`. Exact where the box is thicker than one leaf along one axis at most.
void fill_box(Octree& octree, const LeafBox& box) {
  for (int z = box[2].min; z <= box[2].max; ++z) {
    for (int y = box[1].min; y <= box[1].max; ++y) {
      for (int x = box[0].min; x <= box[0].max; ++x) {
        octree.set({x, y, z});
      }
    }
  }
}

/// Sets the leaves of a box that is one leaf thick along `axes.w`: a leaf is met if its projection
/// along that axis is.
void voxelize_2d(Octree& octree, const Triangle& triangle, const LeafBox& box, const Axes& axes) {
  const Projection2d projection = triangle.project(axes);
  std::array<int, 3> leaf{};
  leaf[axes.w] = box[axes.w].min;
  for (leaf[axes.v] = box[axes.v].min; leaf[axes.v] <= box[axes.v].max; ++leaf[axes.v]) {
    for (leaf[axes.u] = box[axes.u].min; leaf[axes.u] <= box[axes.u].max; ++leaf[axes.u]) {
      if (projection.meets(leaf[axes.u], leaf[axes.v])) {
        octree.set({leaf[0], leaf[1], leaf[2]});
      }
    }
  }
}

/// Sets the leaves of a box by all tests: the triangle's plane and its three projections.
void voxelize_3d(Octree& octree, const Triangle& triangle, const LeafBox& box) {
  const Plane plane(triangle);
  const Axes axes = plane.axes();
  const Projection2d across_w = triangle.project(axes);
  const Projection2d across_u = triangle.project(all_axes[axes.u]);  // on the plane of v and w
  const Projection2d across_v = triangle.project(all_axes[axes.v]);  // on the plane of w and u
  std::array<int, 3> leaf{};
  for (leaf[axes.v] = box[axes.v].min; leaf[axes.v] <= box[axes.v].max; ++leaf[axes.v]) {
    for (leaf[axes.u] = box[axes.u].min; leaf[axes.u] <= box[axes.u].max; ++leaf[axes.u]) {
      if (!across_w.meets(leaf[axes.u], leaf[axes.v])) {
        continue;
      }
      const Interval met = plane.w_interval(leaf[axes.u], leaf[axes.v], box[axes.w]);
      for (leaf[axes.w] = met.min; leaf[axes.w] <= met.max; ++leaf[axes.w]) {
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
  voxelize_triangle(octree, a, b, c, layers, SnapGrid::bits - octree.levels());
}

void voxelize_triangle(Octree& octree, const SnapPoint& a, const SnapPoint& b, const SnapPoint& c,
                       const LeafLayers& layers, int leaf_bits) {
  const int last = octree.leaves_per_side() - 1;
  LeafBox box;  // of the leaves in the root and the layers
  std::array<bool, 3> thick{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Interval whole{std::min({a[axis], b[axis], c[axis]}) >> leaf_bits,
                         std::max({a[axis], b[axis], c[axis]}) >> leaf_bits};
    thick[axis] = whole.min < whole.max;
    box[axis] = intersection(whole, {0, last});
  }
  box[2] = intersection(box[2], {layers.low, layers.high});
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
