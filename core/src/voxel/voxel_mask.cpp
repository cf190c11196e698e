#include "voxel/voxel_mask.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <utility>

#include "octurn/snapshot.hpp"
#include "voxel/connected_components.hpp"

namespace octurn {
void assign(std::span<std::uint64_t> row, int first, int end, bool value) {
  for (int x = first; x < end;) {
    const int next = std::min((x / 64 + 1) * 64, end);
    const std::uint64_t ones =
        next - x == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << (next - x)) - 1;
    std::uint64_t& word = row[static_cast<std::size_t>(x) / 64];
    word = value ? word | ones << (x % 64) : word & ~(ones << (x % 64));
    x = next;
  }
}

VoxelMask::VoxelMask(const Index3& low, const Index3& end)
    : low_(low),
      size_{end.x - low.x, end.y - low.y, end.z - low.z},
      words_((static_cast<std::size_t>(size_.x) + 63) / 64),
      bits_(words_ * static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z)) {}

std::uint64_t VoxelMask::count() const {
  std::uint64_t count = 0;
  for (const std::uint64_t word : bits_) {
    count += static_cast<std::uint64_t>(std::popcount(word));
  }
  return count;
}

/// The result does not depend on the order in which voxels are removed, so that only changed rows
/// and their neighbours are examined again.
void VoxelMask::remove_spurs(const std::stop_token& stop) {
  std::vector<char> pending(static_cast<std::size_t>(size_.y) * static_cast<std::size_t>(size_.z),
                            1);
  const auto row_at = [&](int y, int z) -> char& {
    return pending[static_cast<std::size_t>(z) * static_cast<std::size_t>(size_.y) +
                   static_cast<std::size_t>(y)];
  };
  for (bool removed = true; removed;) {
    removed = false;
    for (int z = 0; z < size_.z; ++z) {
      throw_if_stopped(stop);
      for (int y = 0; y < size_.y; ++y) {
        if (std::exchange(row_at(y, z), 0) == 0 || !remove_spurs_of(y, z)) {
          continue;
        }
        removed = true;
        row_at(y, z) = 1;
        row_at(std::max(y - 1, 0), z) = 1;
        row_at(std::min(y + 1, size_.y - 1), z) = 1;
        row_at(y, std::max(z - 1, 0)) = 1;
        row_at(y, std::min(z + 1, size_.z - 1)) = 1;
      }
    }
  }
}

/// Removes the voxels of a row with at most one face neighbour. @return whether there were any
bool VoxelMask::remove_spurs_of(int y, int z) {
  const auto voxels = row(y, z);
  const auto word = [&](int other_y, int other_z, std::size_t i) {
    const bool is_there = other_y >= 0 && other_z >= 0 && other_y < size_.y && other_z < size_.z;
    return is_there ? bits_[first_word(other_y, other_z) + i] : 0;
  };
  bool removed = false;
  for (std::size_t i = 0; i < words_; ++i) {
    if (voxels[i] == 0) {
      continue;
    }
    std::uint64_t any = 0;
    std::uint64_t two = 0;
    for (const std::uint64_t neighbours :
         {voxels[i] << 1 | (i > 0 ? voxels[i - 1] >> 63 : 0),
          voxels[i] >> 1 | (i + 1 < words_ ? voxels[i + 1] << 63 : 0), word(y - 1, z, i),
          word(y + 1, z, i), word(y, z - 1, i), word(y, z + 1, i)}) {
      two |= any & neighbours;
      any |= neighbours;
    }
    removed = removed || (voxels[i] & ~two) != 0;
    voxels[i] &= two;
  }
  return removed;
}

VoxelMask VoxelMask::cropped() const {
  std::vector<std::uint64_t> columns(words_);  // bitwise or of all rows
  Index3 first{size_.x, size_.y, size_.z};
  Index3 last{-1, -1, -1};
  for (int z = 0; z < size_.z; ++z) {
    for (int y = 0; y < size_.y; ++y) {
      const auto voxels = row(y, z);
      if (std::ranges::any_of(voxels, [](std::uint64_t word) { return word != 0; })) {
        first = {first.x, std::min(first.y, y), std::min(first.z, z)};
        last = {last.x, std::max(last.y, y), std::max(last.z, z)};
        std::ranges::transform(columns, voxels, columns.begin(), std::bit_or());
      }
    }
  }
  if (last.y < 0) {
    return {low_, low_};
  }
  for (std::size_t word = 0; word < words_; ++word) {
    if (columns[word] != 0) {
      const int at = static_cast<int>(word) * 64;
      first.x = std::min(first.x, at + std::countr_zero(columns[word]));
      last.x = at + 63 - std::countl_zero(columns[word]);
    }
  }
  const std::size_t added = first.x == 0 ? 1 : 0;  // words, for the margin before the first voxel
  const std::size_t skipped = static_cast<std::size_t>(std::max(first.x - 1, 0)) / 64;
  VoxelMask mask({low_.x + 64 * (static_cast<int>(skipped) - static_cast<int>(added)),
                  low_.y + first.y - 1, low_.z + first.z},
                 {low_.x + last.x + 2, low_.y + last.y + 2, low_.z + last.z + 1});
  for (int z = first.z; z <= last.z; ++z) {
    for (int y = first.y; y <= last.y; ++y) {
      const auto from = row(y, z).subspan(skipped);
      const auto to = mask.row(y - first.y + 1, z - first.z).subspan(added);
      std::ranges::copy(from.first(std::min(from.size(), to.size())), to.begin());
    }
  }
  return mask;
}

std::uint64_t VoxelMask::component_count(const std::stop_token& stop) const {
  ConnectedComponents components(*this, ConnectedComponents::Of::voxels, stop);
  std::uint64_t count = 0;
  components.for_each(
      [&](int, int, std::uint32_t i, const Run&) { count += components.root(i) == i ? 1 : 0; });
  return count;
}

void VoxelMask::fill_cavities(const std::stop_token& stop) {
  ConnectedComponents gaps(*this, ConnectedComponents::Of::gaps, stop);
  std::vector<char> outside(gaps.count());
  const auto at_border = [&](int y, int z, const Run& run) {
    return run.first == 0 || run.end == size_.x || y == 0 || y == size_.y - 1 || z == 0 ||
           z == size_.z - 1;
  };
  gaps.for_each([&](int y, int z, std::uint32_t i, const Run& run) {
    char& mark = outside[gaps.root(i)];
    mark = static_cast<char>(mark | (at_border(y, z, run) ? 1 : 0));
  });
  gaps.for_each([&](int y, int z, std::uint32_t i, const Run& run) {
    if (outside[gaps.root(i)] == 0) {
      assign(row(y, z), run.first, run.end, true);
    }
  });
}

}  // namespace octurn
