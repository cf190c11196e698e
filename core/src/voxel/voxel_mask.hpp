#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "voxel/index3.hpp"

namespace octurn {

/// Sets or clears the half-open range of bits from `first` to `end`.
void assign(std::span<std::uint64_t> row, int first, int end, bool value);

/// A set of voxels in a box of a grid, as a bitmap in rows along x.
///
/// Members that take a stop token throw `Stopped` between two layers; the mask is then incomplete.
class VoxelMask {
 public:
  /// An empty mask of the half-open box from `low` to `end`.
  VoxelMask(const Index3& low, const Index3& end);

  const Index3& low() const { return low_; }
  const Index3& size() const { return size_; }
  std::size_t words_per_row() const { return words_; }

  /// A row of the box, indexed from `low`; bits past its end are 0.
  std::span<std::uint64_t> row(int y, int z) { return {&bits_[first_word(y, z)], words_}; }
  std::span<const std::uint64_t> row(int y, int z) const {
    return {&bits_[first_word(y, z)], words_};
  }

  /// Indexed from `low`; false outside the box.
  bool contains(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < size_.x && y < size_.y && z < size_.z &&
           (row(y, z)[static_cast<std::size_t>(x) / 64] >> (x % 64) & 1) != 0;
  }

  std::uint64_t count() const;
  std::size_t bytes() const { return bits_.size() * sizeof bits_[0]; }

  /// Removes spurs, which are one voxel thick along two axes, from their ends: voxels with at most
  /// one face neighbour, until there are none. Plates, thin along one axis only, stay.
  void remove_spurs(const std::stop_token& stop = {});

  /// The same voxels in a smaller box, with a margin of at least one empty voxel in x and y.
  VoxelMask cropped() const;

  /// The number of connected components.
  std::uint64_t component_count(const std::stop_token& stop = {}) const;

  /// Fills cavities: gaps that no path through voxels' faces and edges joins to a side of the box.
  void fill_cavities(const std::stop_token& stop = {});

 private:
  bool remove_spurs_of(int y, int z);

  std::size_t first_word(int y, int z) const {
    return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size_.y) +
            static_cast<std::size_t>(y)) *
           words_;
  }

  Index3 low_;
  Index3 size_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_ = {};
};

}  // namespace octurn
