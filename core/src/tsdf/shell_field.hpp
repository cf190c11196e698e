#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/shell.hpp"
#include "voxel/index3.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// The signed distances of a box of bricks of a shell; missing bricks are outside. Voxels are
/// indexed as in a `TileLattice`.
class ShellField {
 public:
  static constexpr bool has_platform = false;

  /// @param low   the first brick. @param size  bricks along each axis
  ShellField(double root_side, double voxel_side, const Index3& low, const Index3& size);

  /// Adds a brick, which must lie in the box.
  void add(const Index3& position, const ShellBrick& brick);

  double voxel_side() const { return voxel_side_; }
  double centre(int voxel, std::size_t axis) const {
    return (voxel + 0.5) * voxel_side_ - (axis < 2 ? root_side_ / 2 : 0.0);
  }
  float half_voxel() const;  ///< ticks
  HoleFilledSdf::Value at(const Index3& voxel) const;

  /// The voxels inside of a half-open box.
  VoxelMask inside(const Index3& low, const Index3& end) const;

 private:
  const ShellBrick* find(const Index3& brick) const;

  double root_side_;
  double voxel_side_;
  Index3 low_;
  Index3 size_;
  std::vector<std::uint32_t> table_;  // index in `bricks_` plus 1; 0: there is none
  std::vector<ShellBrick> bricks_ = {};
};

}  // namespace octurn
