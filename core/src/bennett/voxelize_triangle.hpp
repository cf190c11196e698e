#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "voxel/octree.hpp"

namespace octurn {

/// A point in whole half-units of a `SnapGrid`.
using SnapPoint = std::array<std::int32_t, 3>;

/// The grid that triangles' corners are snapped to: 2^18 units on a side of the root. A grid point
/// is the middle of a unit, so that its coordinates in half-units are odd, and none lies on the
/// face of a node. With a root of 1 m a unit is 3.8 micrometres.
class SnapGrid {
 public:
  static constexpr int bits = 19;  // a side of the root is 2^19 half-units

  /// @param root_side  metres
  explicit SnapGrid(double root_side) : units_per_metre_(units_per_side / root_side) {}

  /// The grid point nearest to `point` (metres, object's frame); nothing if it is `no_point`, or
  /// further from the root than the root is wide.
  std::optional<SnapPoint> snap(const Eigen::Vector3f& point) const {
    // Counted from one side of the root below its lowest corner, so that the cast rounds down.
    const double x = static_cast<double>(point.x()) * units_per_metre_ + 1.5 * units_per_side;
    const double y = static_cast<double>(point.y()) * units_per_metre_ + 1.5 * units_per_side;
    const double z = static_cast<double>(point.z()) * units_per_metre_ + units_per_side;
    const auto is_near = [](double at) { return at >= 0 && at < 3.0 * units_per_side; };
    if (!is_near(x) || !is_near(y) || !is_near(z)) {
      return std::nullopt;
    }
    const auto odd = [](double at) {
      return (static_cast<std::int32_t>(at) - units_per_side) * 2 + 1;
    };
    return SnapPoint{odd(x), odd(y), odd(z)};
  }

 private:
  static constexpr int units_per_side = 1 << (bits - 1);
  double units_per_metre_;
};

/// The layers of leaves from `low` to `high`, both included, counted from the root's bottom.
struct LeafLayers {
  int low = 0;
  int high = (1 << Octree::max_levels) - 1;
};

/// Sets the leaves of those layers that a triangle intersects; leaves are closed boxes. Parts of
/// the triangle outside the root are ignored.
///
/// Exact: all arithmetic is on integers. The leaves therefore depend neither on the processor nor
/// on the order of triangles and corners, and a coarser level has the nodes that voxelizing at that
/// level would set. The test is that of Schwarz and Seidel 2010 (Fast parallel surface and solid
/// voxelization on GPUs, section 3.1): box against box, box against plane, and the projections of
/// both along the three axes. Most triangles are as small as a leaf and need only the first.
///
/// @throws OutOfBudget  with some of the leaves set; calling again with more memory sets all
void voxelize_triangle(Octree& octree, const SnapPoint& a, const SnapPoint& b, const SnapPoint& c,
                       const LeafLayers& layers = {});

/// The same for corners in half-units of another size.
/// @param leaf_bits  a leaf's side is 2^leaf_bits half-units; with the octree's levels at most
///                   `SnapGrid::bits`
void voxelize_triangle(Octree& octree, const SnapPoint& a, const SnapPoint& b, const SnapPoint& c,
                       const LeafLayers& layers, int leaf_bits);

}  // namespace octurn
