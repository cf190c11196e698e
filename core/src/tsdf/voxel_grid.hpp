#pragma once

#include <array>
#include <cstddef>
#include <utility>

#include "octurn/reconstruct.hpp"
#include "octurn/snapshot.hpp"
#include "voxel/index3.hpp"

namespace octurn {

/// Geometry of a TSDF volume: bricks of 8 x 8 x 8 voxels that cover the clip box, and a border of
/// one brick on each side, which stays empty.
///
/// Blocks are coarser than voxels and finer than bricks: free space is counted and holes are filled
/// by block. Bricks and blocks are indexed from the grid's lowest corner, voxels from the lowest
/// corner of the root cube.
class VoxelGrid {
 public:
  static constexpr int brick_side = 8;  ///< voxels

  /// Distances are stored as integers: this many ticks in a truncation.
  static constexpr int ticks = 32000;

  /// @param root_side   metres, of the root cube, which stands on the platform: x and y from
  ///                    -side/2 to side/2, z from 0 to side
  /// @param levels      times that the root cube is halved to get voxels
  /// @param clip        metres, platform frame
  /// @param truncation  metres
  /// @param below       bricks below z = 0 that belong to the volume, for a surface at z = 0 that
  ///                    is seen from below
  VoxelGrid(double root_side, int levels, const Box& clip, double truncation, int below = 0);

  double root_side() const { return root_side_; }
  int levels() const { return levels_; }
  double voxel_side() const { return voxel_side_; }
  double truncation() const { return truncation_; }

  /// The first brick, counted from the root's lowest corner.
  const Index3& low() const { return low_; }

  /// Bricks along each axis.
  const Index3& size() const { return size_; }

  /// Voxels along a side of a block: 2, 4 or 8.
  int block_voxels() const { return block_voxels_; }
  int blocks_per_brick() const { return brick_side / block_voxels_; }

  /// The place of a voxel among the samples of its brick.
  static std::size_t sample_index(const Index3& voxel) {
    return static_cast<std::size_t>((voxel.x & 7) | (voxel.y & 7) << 3 | (voxel.z & 7) << 6);
  }

  /// The coordinate of a voxel's centre on one axis (0 to 2), metres, platform frame.
  double centre(int voxel, std::size_t axis) const {
    return (voxel + 0.5) * voxel_side_ - (axis < 2 ? root_side_ / 2 : 0.0);
  }

  /// The box of all bricks, metres, platform frame.
  Box box() const;

  /// Whether a brick belongs to the border around the clip box.
  bool is_border(const Index3& brick) const {
    return brick.x == 0 || brick.y == 0 || brick.z == 0 || brick.x == size_.x - 1 ||
           brick.y == size_.y - 1 || brick.z == size_.z - 1;
  }

  /// Row-major indices into tables of all bricks, or of all blocks; z varies slowest.
  std::size_t brick_index(const Index3& brick) const {
    return static_cast<std::size_t>((brick.z * size_.y + brick.y) * size_.x + brick.x);
  }
  std::size_t block_index(const Index3& block) const {
    const int per_brick = blocks_per_brick();
    return (static_cast<std::size_t>(block.z) * static_cast<std::size_t>(size_.y * per_brick) +
            static_cast<std::size_t>(block.y)) *
               static_cast<std::size_t>(size_.x * per_brick) +
           static_cast<std::size_t>(block.x);
  }
  std::size_t brick_count() const { return brick_index({0, 0, size_.z}); }
  std::size_t block_count() const { return block_index({0, 0, size_.z * blocks_per_brick()}); }

 private:
  double root_side_;
  int levels_;
  double voxel_side_;
  double truncation_;
  int block_voxels_;
  Index3 low_ = {};
  Index3 size_ = {};
};

inline constexpr int brick_side = VoxelGrid::brick_side;

/// The half-space below the platform of one of several poses. It holds nothing of the object.
class PlatformCut {
 public:
  PlatformCut(const VoxelGrid& grid, const Placement& placement);

  /// Height of a voxel's centre above the platform, in ticks of the grid's truncation.
  float height(const Index3& voxel) const {
    return offset_ + step_[0] * static_cast<float>(voxel.x) +
           step_[1] * static_cast<float>(voxel.y) + step_[2] * static_cast<float>(voxel.z);
  }

  /// The minimum and maximum height in the half-open box of voxels from `low` on.
  std::pair<float, float> heights(const Index3& low, const Index3& size) const;

  /// The voxel right above a lower one, at that height in ticks.
  Index3 raised(const Index3& voxel, float to_height) const;

 private:
  std::array<float, 3> step_ = {};  // ticks for a voxel along each axis
  float offset_ = 0;                // of the voxel (0, 0, 0)
  float square_ = 1;                // squared length of the steps
};

/// The voxel grid of the method `solid`, with its truncation.
VoxelGrid make_solid_grid(const ReconstructOptions& options);

}  // namespace octurn
