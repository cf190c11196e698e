#include "tsdf/standing_parts.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "voxel/connected_components.hpp"

namespace octurn {
namespace {

// A component whose lowest voxel is at most this high stands on the platform; a higher one hovers.
// Hole filling extends free space into the unobserved space below an overhang: a ball of 9 cm ended
// 9 mm above the platform.
constexpr double max_gap = 0.012;       // metres
constexpr double max_foot_top = 0.025;  // metres above the platform

// Thinner columns are no foot: gaps between the rays that passed below the object.
constexpr double min_foot = 0.004;  // metres

// The platform's noise makes crumbs of up to 30 mm3.
constexpr double min_part_volume = 1e-7;  // cubic metres

}  // namespace

std::uint64_t min_part_voxels(const HoleFilledSdf& sdf) {
  return static_cast<std::uint64_t>(std::ceil(min_part_volume / std::pow(sdf.voxel_side(), 3)));
}

namespace {

/// The lowest voxel of a column that has none.
constexpr int no_foot = -1;

int layers_in(double height, const HoleFilledSdf& sdf) {
  return static_cast<int>(std::floor(height / sdf.voxel_side())) + 1;
}

bool is_empty(std::span<const std::uint64_t> row) {
  return std::ranges::all_of(row, [](std::uint64_t word) { return word == 0; });
}

bool stands(const VoxelMask& mask) {
  for (int y = 0; y < mask.size().y; ++y) {
    if (mask.size().z > 0 && !is_empty(mask.row(y, 0))) {
      return true;
    }
  }
  return false;
}

/// For each column its lowest voxel, if that belongs to a component that ends just above the
/// platform; else `no_foot`.
std::vector<int> find_soles(const VoxelMask& mask, const HoleFilledSdf& sdf,
                            const std::stop_token& stop) {
  ConnectedComponents components(mask, ConnectedComponents::Of::voxels, stop);
  const std::vector<std::uint64_t> volumes = components.volumes();
  std::vector<int> lowest(components.count(), no_foot);
  components.for_each([&](int, int z, std::uint32_t i, const Run&) {
    int& layer = lowest[components.root(i)];
    layer = layer == no_foot ? z : layer;
  });
  const auto hovers = [&, gap = layers_in(max_gap, sdf)](std::uint32_t root) {
    return lowest[root] > 0 && lowest[root] < gap && volumes[root] >= min_part_voxels(sdf);
  };
  const auto width = static_cast<std::size_t>(mask.size().x);
  std::vector<int> soles(width * static_cast<std::size_t>(mask.size().y), no_foot);
  components.for_each([&](int y, int z, std::uint32_t i, const Run& run) {
    if (z < layers_in(max_foot_top, sdf) && hovers(components.root(i))) {
      for (int x = run.first; x < run.end; ++x) {
        int& sole = soles[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)];
        sole = sole == no_foot ? z : sole;
      }
    }
  });
  return soles;
}

/// Columns of a mask, 1 for those in a set, x the fastest.
using Columns = std::vector<char>;

/// Dilates the set of columns that have `value`, by `reach` columns in x and y.
Columns spread(const Columns& columns, const Index3& size, int reach, char value) {
  Columns result = columns;
  const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * size.x + x); };
  const auto is_near = [&](int x, int y) {
    for (int v = std::max(y - reach, 0); v <= std::min(y + reach, size.y - 1); ++v) {
      for (int u = std::max(x - reach, 0); u <= std::min(x + reach, size.x - 1); ++u) {
        if (columns[at(u, v)] == value) {
          return true;
        }
      }
    }
    return false;
  };
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x) {
      result[at(x, y)] = is_near(x, y) ? value : columns[at(x, y)];
    }
  }
  return result;
}

/// The columns with such a lowest voxel below which no ray passed.
Columns hidden_columns(const VoxelMask& mask, const HoleFilledSdf& sdf,
                       const std::vector<int>& soles) {
  const Index3& low = mask.low();
  Columns hidden(soles.size());
  std::size_t column = 0;
  for (int y = 0; y < mask.size().y; ++y) {
    for (int x = 0; x < mask.size().x; ++x, ++column) {
      bool is_hidden = soles[column] != no_foot;
      for (int z = 0; is_hidden && z < soles[column]; ++z) {
        is_hidden = !sdf.is_seen_empty({low.x + x, low.y + y, low.z + z});
      }
      hidden[column] = static_cast<char>(is_hidden);
    }
  }
  return hidden;
}

/// Extends components that end just above the platform down to it, in these columns.
void add_feet(VoxelMask& mask, const HoleFilledSdf& sdf, const std::stop_token& stop) {
  const std::vector<int> soles = find_soles(mask, sdf, stop);
  const Index3& size = mask.size();
  const int reach = std::max(1, static_cast<int>(std::lround(min_foot / 2 / sdf.voxel_side())));
  // An erosion, then a dilation: a morphological opening removes thin columns.
  const Columns feet =
      spread(spread(hidden_columns(mask, sdf, soles), size, reach, 0), size, reach, 1);
  std::size_t column = 0;
  for (int y = 0; y < size.y; ++y) {
    for (int x = 0; x < size.x; ++x, ++column) {
      for (int z = 0; feet[column] != 0 && z < soles[column]; ++z) {
        assign(mask.row(y, z), x, x + 1, true);
      }
    }
  }
}

}  // namespace

StandingParts standing_parts(const HoleFilledSdf& sdf, Parts parts, const std::stop_token& stop,
                             ThreadTeam& team) {
  const int layers = layers_in(max_gap, sdf);
  StandingParts standing{.mask = sdf.inside(stop, team)};
  if (parts == Parts::main) {
    standing.dropped = keep_main_component(standing.mask, layers, stop);
    if (stands(standing.mask)) {
      return standing;
    }
    standing.mask = sdf.inside(stop, team);  // anew, with the components that were dropped
  }
  add_feet(standing.mask, sdf, stop);
  standing.dropped = parts == Parts::main ? keep_main_component(standing.mask, layers, stop)
                                          : keep_standing_components(standing.mask, layers,
                                                                     min_part_voxels(sdf), stop);
  return standing;
}

}  // namespace octurn
