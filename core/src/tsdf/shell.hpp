#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "octurn/reconstruct.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "tsdf/voxel_grid.hpp"
#include "voxel/index3.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

// The shell that the method `solid` makes of a space: it reaches from the observed surface to a
// thickness behind it, because the other side of a wall is unknown. Where nothing was observed
// there is no shell.

/// 8 x 8 x 8 voxels in the order of `TsdfBrick`: distances to the shell's surface in ticks,
/// negative inside; `not_observed` where nothing was.
struct ShellBrick {
  static constexpr std::int16_t not_observed = std::numeric_limits<std::int16_t>::max();
  std::array<std::int16_t, TsdfBrick::samples> distance = {};
};

/// Ticks of a voxel's side. The truncation is four voxels and the shell two voxels thick: voxels on
/// both sides of the shell's back must be observed, and weights fall to zero at the truncation.
inline constexpr int shell_voxel_ticks = VoxelGrid::ticks / 4;
inline constexpr int shell_thickness_voxels = 2;

/// Metres: depth at which a whole window of readings has the weight 1, for a hand-held sensor in a
/// room. An observed surface needs a tenth of that weight.
inline constexpr double shell_reference_depth = 3.0;

/// The grid of a tile, in the frame in which it is the root cube.
VoxelGrid make_shell_grid(const ReconstructOptions& options);

/// Makes the shell in a brick of a TSDF.
/// @return whether any voxel is inside, or next to one that may be
bool make_shell(const CompactBrick& from, ShellBrick& shell);

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
