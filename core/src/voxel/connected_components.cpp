#include "voxel/connected_components.hpp"

#include <algorithm>
#include <bit>
#include <limits>

namespace octurn {

ConnectedComponents::ConnectedComponents(const VoxelMask& mask, Of of, const std::stop_token& stop)
    : mask_(mask), of_(of), stop_(stop) {
  const Index3& size = mask.size();
  first_.reserve(static_cast<std::size_t>(size.y) * static_cast<std::size_t>(size.z) + 1);
  for (int z = 0; z < size.z; ++z) {
    throw_if_stopped(stop_);
    for (int y = 0; y < size.y; ++y) {
      first_.push_back(static_cast<std::uint32_t>(runs_.size()));
      add_row(y, z);
      join_row(y, z);
    }
  }
  first_.push_back(static_cast<std::uint32_t>(runs_.size()));
}

std::uint32_t ConnectedComponents::root(std::uint32_t run) {
  while (runs_[run].parent != run) {
    runs_[run].parent = runs_[runs_[run].parent].parent;
    run = runs_[run].parent;
  }
  return run;
}

std::vector<std::uint64_t> ConnectedComponents::volumes() {
  std::vector<std::uint64_t> by_root(runs_.size());
  for (std::uint32_t i = 0; i < runs_.size(); ++i) {
    by_root[root(i)] += static_cast<std::uint64_t>(runs_[i].end - runs_[i].first);
  }
  return by_root;
}

void ConnectedComponents::add_row(int y, int z) {
  const auto row = mask_.row(y, z);
  const std::uint64_t flip = of_ == Of::gaps ? ~std::uint64_t{0} : 0;
  const auto next = [&](int from, std::uint64_t invert) {
    std::size_t word = static_cast<std::size_t>(from) / 64;
    if (from >= mask_.size().x) {
      return mask_.size().x;
    }
    std::uint64_t bits = (row[word] ^ flip ^ invert) >> (from % 64) << (from % 64);
    while (bits == 0) {
      if (++word == row.size()) {
        return mask_.size().x;
      }
      bits = row[word] ^ flip ^ invert;
    }
    return std::min(static_cast<int>(word) * 64 + std::countr_zero(bits), mask_.size().x);
  };
  for (int x = next(0, 0); x < mask_.size().x;) {
    const int end = next(x, ~std::uint64_t{0});
    runs_.push_back({x, end, static_cast<std::uint32_t>(runs_.size())});
    x = next(end, 0);
  }
}

void ConnectedComponents::join_row(int y, int z) {
  // The background is 18-connected (faces and edges): reach 1 adds the neighbours across xy and
  // xz edges, the rows (y - 1, z - 1) and (y + 1, z - 1) those across yz edges.
  const int reach = of_ == Of::gaps ? 1 : 0;
  if (y > 0) {
    join(y - 1, z, reach);
  }
  if (z > 0) {
    join(y, z - 1, reach);
    if (of_ == Of::gaps && y > 0) {
      join(y - 1, z - 1, 0);
    }
    if (of_ == Of::gaps && y + 1 < mask_.size().y) {
      join(y + 1, z - 1, 0);
    }
  }
}

/// Joins the runs of the last row with those of an earlier one that come within `reach`.
void ConnectedComponents::join(int y, int z, int reach) {
  const auto row = static_cast<std::size_t>(z) * static_cast<std::size_t>(mask_.size().y) +
                   static_cast<std::size_t>(y);
  std::uint32_t other = first_[row];
  const std::uint32_t others = first_[row + 1];
  for (std::uint32_t i = first_.back(); i < runs_.size(); ++i) {
    while (other < others && runs_[other].end + reach <= runs_[i].first) {
      ++other;
    }
    for (std::uint32_t j = other; j < others && runs_[j].first < runs_[i].end + reach; ++j) {
      const std::uint32_t a = root(i);
      const std::uint32_t b = root(j);
      runs_[std::max(a, b)].parent = std::min(a, b);
    }
  }
}

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
