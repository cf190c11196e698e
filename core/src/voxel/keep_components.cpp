#include "voxel/keep_components.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "voxel/connected_components.hpp"

namespace octurn {
namespace {

// The volume of a component that stands on the platform is multiplied by this factor: the object
// stands, even below something larger. With a larger factor a speck on the platform would win over
// a ball whose foot is hardly seen.
constexpr std::uint64_t base_weight = 8;

constexpr std::uint64_t no_others = std::numeric_limits<std::uint64_t>::max();

}  // namespace

DroppedComponents keep_standing_components(VoxelMask& mask, int standing_layers,
                                           std::uint64_t min_voxels, const std::stop_token& stop) {
  ConnectedComponents components(mask, ConnectedComponents::Of::voxels, stop);
  DroppedComponents dropped;
  if (components.count() == 0) {
    return dropped;
  }
  const std::vector<std::uint64_t> volumes = components.volumes();
  std::vector<char> stands(components.count());
  components.for_each([&](int, int z, std::uint32_t i, const Run&) {
    const std::uint32_t root = components.root(i);
    stands[root] = static_cast<char>(stands[root] | (z < standing_layers ? 1 : 0));
  });
  std::size_t main = 0;
  const auto weighed = [&](std::size_t i) {
    return volumes[i] * (stands[i] != 0 ? base_weight : 1);
  };
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    main = weighed(i) > weighed(main) ? i : main;
  }
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    stands[i] = static_cast<char>(i == main || (stands[i] != 0 && volumes[i] >= min_voxels));
    if (stands[i] == 0 && volumes[i] > 0) {
      ++dropped.count;
      dropped.voxels += volumes[i];
    }
  }
  components.for_each([&](int y, int z, std::uint32_t i, const Run& run) {
    if (stands[components.root(i)] == 0) {
      assign(mask.row(y, z), run.first, run.end, false);
    }
  });
  return dropped;
}

DroppedComponents keep_main_component(VoxelMask& mask, int standing_layers,
                                      const std::stop_token& stop) {
  return keep_standing_components(mask, standing_layers, no_others, stop);
}

}  // namespace octurn
