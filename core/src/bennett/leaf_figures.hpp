#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bennett/pseudo_voxels.hpp"
#include "mesh/surface_cells.hpp"
#include "octurn/snapshot.hpp"
#include "voxel/octree.hpp"

namespace octurn {

/// Measures the surface of `marching_tetrahedra` by its leaves, at a fraction of the cost of
/// measuring its facets. All sums are of integers: slabs and their order change no bit.
class LeafFigures {
 public:
  explicit LeafFigures(const Octree& octree);

  /// Adds a slab of an octree of the same side and levels. Slabs must be disjoint.
  void add(const Octree& octree, const BrickLayers& slab);

  std::uint64_t leaves() const { return leaves_; }

  /// Whether each brick of pseudo-voxels meets its six neighbours in the same corners; inside a
  /// brick the surface is closed by construction.
  ///
  /// Each side that the surface crosses adds a 64-bit hash of its 9 x 9 corners, and subtracts it
  /// for the neighbour; an open surface leaves 0 with a chance of 2^-64.
  bool closed() const { return leaves_ > 0 && sides_ == 0; }

  /// Cubic metres.
  double volume() const;

  /// The surface's bounding box, metres, as rounded in its facets.
  Box bounds() const;

  const SurfaceCells& surface() const { return surface_; }

  /// Metres: the middles of every n-th leaf, at most `max_sample`, layer by layer.
  std::vector<Eigen::Vector3d> sample() const;

  static constexpr std::size_t max_sample = 1024;

 private:
  void add_leaves(const Index3& position, const Brick& brick);
  void add_cells(const Index3& position, const Brick& brick);
  void add_sides(const PseudoVoxelBrick& brick);
  void add_sample(const Index3& position, const Brick& brick);

  double low_xy_;     // metres
  double leaf_side_;  // metres
  int cell_leaves_;   // leaves along a side of what is added to `surface_` at once
  std::uint64_t leaves_ = 0;
  std::int64_t excess_ = 0;  // see `TetrahedraCase`
  std::uint64_t sides_ = 0;
  std::array<int, 3> min_ = {};  // lowest leaf on each axis
  std::array<int, 3> end_ = {};  // one past the highest
  SurfaceCells surface_ = {};
  std::uint64_t passed_ = 0;       // leaves of which `sample_` is
  std::uint64_t sample_step_ = 1;  // doubles when there are more than `max_sample`
  std::vector<Index3> sample_ = {};
};

}  // namespace octurn
