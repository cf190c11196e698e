#pragma once

#include <array>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "bennett/voxelize_triangle.hpp"
#include "octurn/stl.hpp"

namespace octurn::plain {

/// The technique as its text tells it, with nothing done for speed: nodes that own their eight
/// children, every triangle tested from the root down by all thirteen separating axes, leaves in a
/// set, pseudo-voxels one by one. It shares nothing with `octurn::Octree` but the snap grid that
/// corners are rounded to. What the fast implementation does must agree with it exactly.
class Octree {
 public:
  explicit Octree(int levels) : levels_(levels) {}

  void voxelize(const std::array<SnapPoint, 3>& corners);

  /// Lowest corners of the leaves, counted in leaves.
  const std::set<std::array<int, 3>>& leaves() const { return leaves_; }

  /// The nodes of a coarser level, likewise.
  std::set<std::array<int, 3>> nodes(int level) const;

 private:
  void voxelize(const std::array<SnapPoint, 3>& corners, int level, const std::array<int, 3>& node);

  int levels_;
  std::set<std::array<int, 3>> leaves_ = {};
};

/// A triangle of the surface: corners in half leaves from the root's lowest corner, outward.
using Triangle = std::array<std::array<int, 3>, 3>;

/// Marching Tetrahedra on the pseudo-voxels of a set of leaves, sorted; each triangle starts with
/// its smallest corner, so that equal surfaces are equal lists.
std::vector<Triangle> marching_tetrahedra(const std::set<std::array<int, 3>>& leaves);

}  // namespace octurn::plain
