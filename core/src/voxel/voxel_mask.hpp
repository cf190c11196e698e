#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "voxel/octree.hpp"

namespace octurn {

/// A set of leaves in a box of the lattice, a bit for each, in rows along x.
///
/// What takes a stop token throws `Stopped` between two layers, and is then left incomplete.
class VoxelMask {
 public:
  /// From `low` up to but without `end`.
  VoxelMask(const Index3& low, const Index3& end);

  const Index3& low() const { return low_; }
  const Index3& size() const { return size_; }
  std::size_t words_per_row() const { return words_; }

  /// A row of the box, counted from `low`; bits past its end are 0.
  std::span<std::uint64_t> row(int y, int z) { return {&bits_[first_word(y, z)], words_}; }
  std::span<const std::uint64_t> row(int y, int z) const {
    return {&bits_[first_word(y, z)], words_};
  }

  /// Counted from `low`; false outside the box.
  bool contains(int x, int y, int z) const {
    return x >= 0 && y >= 0 && z >= 0 && x < size_.x && y < size_.y && z < size_.z &&
           (row(y, z)[static_cast<std::size_t>(x) / 64] >> (x % 64) & 1) != 0;
  }

  std::uint64_t count() const;
  std::size_t bytes() const { return bits_.size() * sizeof bits_[0]; }

  /// Keeps the one part that stands on the platform: of those in the lowest layer of the box the
  /// largest, or the largest of all if none is. Leaves of a part meet in faces.
  void keep_main_component(const std::stop_token& stop = {});

  /// Removes needles one leaf thick, from their ends: leaves that meet no more than one other,
  /// again and again. What is thin along one axis only, stays.
  void remove_spurs(const std::stop_token& stop = {});

  /// The same leaves in a smaller box, which leaves one leaf free, at least, around them in x and
  /// y.
  VoxelMask cropped() const;

  /// How many parts there are.
  std::uint64_t component_count(const std::stop_token& stop = {}) const;

  /// Adds what no way leads to from outside the box, through faces and edges of leaves.
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
