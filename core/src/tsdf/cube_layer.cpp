#include "tsdf/cube_layer.hpp"

#include <array>
#include <bit>
#include <span>

#include "tsdf/marching_cubes_cases.hpp"

namespace octurn {
namespace {

using Row = std::span<const std::uint64_t>;

/// Adds the cubes that the surface crosses, of 64 along x.
/// @param rows   of voxels that they lie between
/// @param width  of the mask, voxels
/// @param size   of a layer of the mask, voxels
void add_mixed(const std::array<Row, 4>& rows, std::size_t word, int y, int width, std::size_t size,
               CubeLayer& layer) {
  std::array<std::uint64_t, 8> corners{};
  std::uint64_t any = 0;
  std::uint64_t all = ~std::uint64_t{0};
  for (std::size_t i = 0; i < 4; ++i) {
    const std::uint64_t next = word + 1 < rows[i].size() ? rows[i][word + 1] : 0;
    corners[2 * i] = rows[i][word];
    corners[2 * i + 1] = rows[i][word] >> 1 | next << 63;
    any |= corners[2 * i] | corners[2 * i + 1];
    all &= corners[2 * i] & corners[2 * i + 1];
  }
  for (std::uint64_t mixed = any & ~all; mixed != 0; mixed &= mixed - 1) {
    const int bit = std::countr_zero(mixed);
    std::size_t pattern = 0;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      pattern |= (corners[corner] >> bit & 1) << corner;
    }
    const int x = static_cast<int>(word) * 64 + bit;
    layer.mixed.push_back({x, y, static_cast<std::uint8_t>(pattern)});
    if (is_self_intersecting_case(pattern)) {
      layer.ambiguous.resize(size);
      layer.ambiguous[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)] = 1;
    }
  }
}

}  // namespace

CubeLayer mixed_cubes(const VoxelMask& inside, int z) {
  CubeLayer layer;
  const Index3& voxels = inside.size();
  const std::vector<std::uint64_t> empty(inside.words_per_row());
  const std::size_t size = static_cast<std::size_t>(voxels.x) * static_cast<std::size_t>(voxels.y);
  const auto row = [&](int y, int at) {
    return at >= 0 && at < voxels.z ? inside.row(y, at) : Row(empty);
  };
  for (int y = 0; y + 1 < voxels.y; ++y) {
    const std::array rows{row(y, z), row(y + 1, z), row(y, z + 1), row(y + 1, z + 1)};
    for (std::size_t word = 0; word < empty.size(); ++word) {
      add_mixed(rows, word, y, voxels.x, size, layer);
    }
  }
  return layer;
}

}  // namespace octurn
