#pragma once

#include <array>
#include <map>
#include <memory>
#include <set>
#include <vector>

#include "bennett/voxelize_triangle.hpp"
#include "octurn/stl.hpp"

namespace octurn::plain {

/// Bennett's octree as the paper describes it, with nothing done for speed: every triangle is
/// tested from the root down against all thirteen separating axes, leaves are kept in a set, and
/// pseudo-voxels are visited one by one. It shares only the snap grid of the corners with
/// `octurn::Octree`. The fast implementation must agree with it exactly.
class Octree {
 public:
  explicit Octree(int levels) : levels_(levels) {}

  void voxelize(const std::array<SnapPoint, 3>& corners);

  /// Lowest corners of the leaves, counted in leaves.
  const std::set<std::array<int, 3>>& leaves() const { return leaves_; }

  /// Lowest corners of the nodes of a coarser level, counted in nodes of that level.
  std::set<std::array<int, 3>> nodes(int level) const;

 private:
  void voxelize(const std::array<SnapPoint, 3>& corners, int level, const std::array<int, 3>& node);

  int levels_;
  std::set<std::array<int, 3>> leaves_ = {};
};

/// A triangle of the surface, counter-clockwise seen from outside; its corners are in half leaves
/// from the root's lowest corner.
using Triangle = std::array<std::array<int, 3>, 3>;

/// Marching tetrahedra on the pseudo-voxels of a set of leaves. The triangles are sorted, each
/// starts with its smallest corner: equal surfaces are equal lists.
std::vector<Triangle> marching_tetrahedra(const std::set<std::array<int, 3>>& leaves);

}  // namespace octurn::plain
