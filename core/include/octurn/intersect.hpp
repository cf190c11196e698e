#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "octurn/octree.hpp"

namespace octurn {

/// A point in whole half-units of a `Lattice`.
using LatticePoint = std::array<std::int32_t, 3>;

/// The lattice that all intersections are decided on: 2^18 units on a side of the root, points in
/// the middle of one, so that their coordinates in half-units are odd, and none lies on a node's
/// face. With a root of 1 m a unit is 3.8 micrometres.
class Lattice {
 public:
  static constexpr int bits = 19;  // a side of the root is 2^19 half-units

  /// @param root_side  metres
  explicit Lattice(double root_side) : units_a_metre_(units_a_side / root_side) {}

  /// The lattice point nearest to `point` (metres, platform frame); nothing if it is no point, or
  /// further outside the root than the root is wide.
  std::optional<LatticePoint> nearest(const Eigen::Vector3f& point) const {
    // Counted from one side of the root below its lowest corner, so that the cast rounds down.
    const double x = static_cast<double>(point.x()) * units_a_metre_ + 1.5 * units_a_side;
    const double y = static_cast<double>(point.y()) * units_a_metre_ + 1.5 * units_a_side;
    const double z = static_cast<double>(point.z()) * units_a_metre_ + units_a_side;
    const auto is_near = [](double at) { return at >= 0 && at < 3.0 * units_a_side; };
    if (!is_near(x) || !is_near(y) || !is_near(z)) {
      return std::nullopt;
    }
    const auto odd = [](double at) {
      return (static_cast<std::int32_t>(at) - units_a_side) * 2 + 1;
    };
    return LatticePoint{odd(x), odd(y), odd(z)};
  }

 private:
  static constexpr int units_a_side = 1 << (bits - 1);
  double units_a_metre_;
};

/// The layers of leaves from `low` to `high`, both included, counted from the root's bottom.
struct LeafLayers {
  int low = 0;
  int high = (1 << Octree::max_levels) - 1;
};

/// Sets the leaves, of those layers, that a triangle meets, their faces included. What lies outside
/// the root meets none.
///
/// Exact: all arithmetic is on integers, so the leaves do not depend on the processor, on the order
/// of triangles or corners, nor, on a coarser level, on the size of the leaves.
/// The test is that of Schwarz and Seidel 2010 (Fast parallel surface and solid voxelization on
/// GPUs, section 3.1): box against box, box against plane, and the box's three shadows against the
/// triangle's. Most triangles are as small as a leaf, and need only the first.
///
/// @throws OctreeFull  some of the leaves are then set; to set all of them, call again
void intersect(Octree& octree, const LatticePoint& a, const LatticePoint& b, const LatticePoint& c,
               const LeafLayers& layers = {});

}  // namespace octurn
