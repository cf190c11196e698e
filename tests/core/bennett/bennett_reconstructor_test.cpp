#include "bennett/bennett_reconstructor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "bennett/voxelize_triangle.hpp"
#include "support/ball_scan.hpp"

namespace octurn {
namespace {

// A second implementation of Bennett 2014 in double precision, without the snap grid: pinhole
// back-projection, triangulation, and a separating axis test of every triangle against every leaf.

using Vector = Eigen::Vector3d;
using Corners = std::array<Vector, 3>;
using Leaves = std::set<std::array<int, 3>>;

std::vector<Corners> triangles_of(const Snapshot& snapshot, double threshold) {
  const Intrinsics& lens = snapshot.intrinsics;
  const auto depth = [&](int u, int v) {
    return snapshot.frame.depth[static_cast<std::size_t>(v * lens.width + u)];
  };
  const auto point = [&](int u, int v) -> Vector {
    const double z = depth(u, v) * lens.depth_unit;
    return snapshot.object_from_sensor *
           Vector((u - lens.cx) * z / lens.fx, (v - lens.cy) * z / lens.fy, z);
  };
  std::vector<Corners> triangles;
  const auto add = [&](const std::array<std::array<int, 2>, 3>& pixels) {
    Corners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      if (depth(pixels[i][0], pixels[i][1]) == 0) {
        return;
      }
      corners[i] = point(pixels[i][0], pixels[i][1]);
    }
    if ((corners[1] - corners[0]).squaredNorm() <= threshold &&
        (corners[2] - corners[1]).squaredNorm() <= threshold &&
        (corners[0] - corners[2]).squaredNorm() <= threshold) {
      triangles.push_back(corners);
    }
  };
  for (int v = 0; v + 1 < lens.height; ++v) {
    for (int u = 0; u + 1 < lens.width; ++u) {
      add({{{u, v}, {u + 1, v}, {u, v + 1}}});
      add({{{u + 1, v}, {u + 1, v + 1}, {u, v + 1}}});
    }
  }
  return triangles;
}

/// Whether a triangle and a cube about the origin meet (Akenine-Moller 2001).
bool meets_cube(const Corners& corners, double half_side) {
  const auto separates = [&](const Vector& axis) {
    const std::array at{axis.dot(corners[0]), axis.dot(corners[1]), axis.dot(corners[2])};
    const double reach = half_side * axis.cwiseAbs().sum();
    return *std::ranges::min_element(at) > reach || *std::ranges::max_element(at) < -reach;
  };
  if (separates((corners[1] - corners[0]).cross(corners[2] - corners[0]))) {
    return false;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Vector unit = Vector::Unit(axis);
    if (separates(unit) || separates(unit.cross(corners[1] - corners[0])) ||
        separates(unit.cross(corners[2] - corners[1])) ||
        separates(unit.cross(corners[0] - corners[2]))) {
      return false;
    }
  }
  return true;
}

/// Adds the leaves that a triangle meets after each leaf's sides are moved outward by `margin`
/// metres (inward if negative).
void add_leaves(Leaves& leaves, const Corners& corners, double leaf_side, double margin) {
  const Vector root_min(-0.5, -0.5, 0);
  const Vector low = (corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]) - root_min) / leaf_side;
  const Vector high = (corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]) - root_min) / leaf_side;
  std::array<int, 3> leaf{};
  const auto first = [&](int axis) { return static_cast<int>(std::floor(low[axis])) - 1; };
  const auto last = [&](int axis) { return static_cast<int>(std::floor(high[axis])) + 1; };
  for (leaf[2] = first(2); leaf[2] <= last(2); ++leaf[2]) {
    for (leaf[1] = first(1); leaf[1] <= last(1); ++leaf[1]) {
      for (leaf[0] = first(0); leaf[0] <= last(0); ++leaf[0]) {
        const Vector centre =
            root_min + (Vector(leaf[0], leaf[1], leaf[2]) + Vector::Constant(0.5)) * leaf_side;
        if (meets_cube({corners[0] - centre, corners[1] - centre, corners[2] - centre},
                       leaf_side / 2 + margin)) {
          leaves.insert(leaf);
        }
      }
    }
  }
}

TEST(BennettReconstructor, FindsTheLeavesOfAnImplementationInFloatingPoint) {
  // Snapping moves a corner by up to half a grid unit per axis, 1.9 micrometres, and the rounding
  // of a float below 1 m by 0.1 micrometres. The snapped triangle therefore meets every leaf that
  // the exact one meets in leaves smaller by `moved`, and none that it misses in larger leaves.
  constexpr double moved = 1.0 / (1 << SnapGrid::bits) + 2e-7;
  constexpr double threshold = 0.0001;
  const SnapshotSource snapshots = ball_scan(4);
  for (const double leaf_side : {1.0 / 256, 1.0 / 1024}) {
    Leaves fewest;
    Leaves all;
    for (std::size_t i = 0; i < snapshots.count; ++i) {
      for (const Corners& corners : triangles_of(snapshots.read(i), threshold)) {
        add_leaves(fewest, corners, leaf_side, -moved);
        add_leaves(all, corners, leaf_side, moved);
      }
    }
    BennettReconstructor reconstructor(
        {.leaf_size = leaf_side, .threshold = threshold, .clip = ball_clip});
    reconstructor.add(snapshots);
    const std::uint64_t leaves = reconstructor.count(snapshots).leaves;
    EXPECT_GE(leaves, fewest.size());
    EXPECT_LE(leaves, all.size());
    EXPECT_GT(fewest.size(), 1000U);
    EXPECT_LT(all.size() - fewest.size(), fewest.size() / 50);  // the bounds are tight
  }
}

}  // namespace
}  // namespace octurn
