#pragma once

#include <array>
#include <cstdint>
#include <stop_token>
#include <vector>

#include "tsdf/compact_tsdf.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// A distance field with a value everywhere: what no snapshot saw is filled in smoothly.
///
/// Leaves that are neither seen nor free take a harmonic function between the others, on the
/// field's cells. Below the foot each layer is as the foot's, and the model ends on the platform's
/// plane.
class HoleFilledSdf {
 public:
  /// @param field  must outlive this
  /// @param foot   the lowest layer of leaves that counts; those below take its values
  /// @throws Stopped
  HoleFilledSdf(const CompactTsdf& field, int foot, const std::stop_token& stop = {});

  /// The box of leaves outside which there is nothing: from `low` up to but without `end`.
  const Index3& low() const { return low_; }
  const Index3& end() const { return end_; }

  double leaf_side() const { return field_.leaf_side(); }
  double centre(int leaf, std::size_t axis) const { return field_.centre(leaf, axis); }

  /// Half a leaf's side in ticks.
  float half_leaf() const {
    return static_cast<float>(field_.leaf_side() / 2 / field_.truncation() * VoxelGrid::ticks);
  }

  struct Value {
    float distance = 0;  // ticks, positive outside
    bool seen = false;
  };

  /// At the centre of a leaf of that box, or of one below it.
  Value at(const Index3& leaf) const;

  /// The leaves of that box at which the distance is negative, but for those on its sides and top.
  /// @throws Stopped
  VoxelMask inside(const std::stop_token& stop = {}) const;

 private:
  struct Grid {
    Index3 size = {};
    std::vector<float> values = {};
    std::vector<char> known = {};
    std::size_t index(int x, int y, int z) const {
      return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) +
              static_cast<std::size_t>(y)) *
                 static_cast<std::size_t>(size.x) +
             static_cast<std::size_t>(x);
    }
  };

  void find_box();
  void classify(const std::stop_token& stop);
  void classify(const Index3& cell, std::size_t index);

  struct RunningMean {
    int known = 0;
    float sum = 0;  // of distances, ticks
    void add(float distance) {
      ++known;
      sum += distance;
    }
  };
  RunningMean mean_known_distance(const CompactBrick& brick, const Index3& position,
                                  const Index3& cell) const;
  static void solve_laplace(Grid& fine, const std::stop_token& stop);
  static void gauss_seidel_sweep(Grid& grid, const std::stop_token& stop);
  static void gauss_seidel_sweep(Grid& grid, int x, int y, int z);
  VoxelState sighted(const Index3& leaf, const CompactBrick* brick) const;
  const CompactBrick* brick_at(const Index3& leaf) const;

  /// The first of two neighbouring cells, and how far it is from its centre to the other's.
  struct LerpWeight {
    int first = 0;
    float part = 0;
  };
  std::vector<LerpWeight> lerp_weights(int leaves, int cells) const;
  float interpolated(const LerpWeight& x, const LerpWeight& y, const LerpWeight& z) const;
  float interpolated(const Index3& leaf) const;
  enum class Side { inside, outside, both };
  Side side_of(const Index3& brick) const;
  std::uint64_t inside(const Index3& first) const;
  void add_inside(const Index3& brick, VoxelMask& set) const;

  const CompactTsdf& field_;
  int base_layer_;
  Index3 low_ = {};
  Index3 end_ = {};
  Index3 low_cell_ = {};
  Grid grid_ = {};
  std::array<std::vector<LerpWeight>, 3> lerp_weights_ = {};  // of the box's leaves on each axis
};

}  // namespace octurn
