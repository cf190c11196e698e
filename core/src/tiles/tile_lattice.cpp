#include "tiles/tile_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "octurn/error.hpp"
#include "voxel/checked_levels.hpp"

namespace octurn {
namespace {

constexpr int max_snap_bits = 7;  // 2^7 units a leaf

// x = 0, the middle of the first tile, must be a boundary of bricks: otherwise tiles of another
// side would have other bricks.
constexpr int min_levels = Brick::levels + 1;

int levels_of_tile(const ReconstructOptions& options) {
  const int finest = checked_levels(options);
  const int levels = options.level.value_or(finest);
  if (levels < min_levels || levels > finest) {
    throw Error(ErrorCode::bad_settings,
                "leaf size: a scan with free poses needs at least " +
                    std::to_string(1 << min_levels) + " leaves along a root cube",
                "Choose a smaller leaf size or a larger root cube.");
  }
  return levels;
}

}  // namespace

TileLattice::TileLattice(const ReconstructOptions& options)
    : root_side_(options.root_size),
      levels_(levels_of_tile(options)),
      leaf_side_(root_side_ / (1 << levels_)),
      leaf_bits_(std::min(max_snap_bits + 1, SnapGrid::bits - levels_)),
      units_per_metre_((1 << (leaf_bits_ - 1)) / leaf_side_) {
  if (options.method != Method::intersection) {
    return;
  }
  if (!std::isfinite(options.threshold) || options.threshold <= 0 ||
      options.threshold > root_side_ * root_side_) {
    throw Error(ErrorCode::bad_settings,
                "threshold: must be above 0, and no side of a triangle longer than a root cube's");
  }
}

std::optional<LatticePoint> TileLattice::snap(const Eigen::Vector3f& point) const {
  const int tile_bits = leaf_bits_ + levels_;
  const double reach = std::ldexp(static_cast<double>(max_index), tile_bits - 1);
  LatticePoint snapped{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double units =
        static_cast<double>(point[static_cast<Eigen::Index>(axis)]) * units_per_metre_;
    if (!(std::abs(units) < reach)) {
      return std::nullopt;
    }
    const std::int64_t half_tile = axis < 2 ? std::int64_t{1} << (tile_bits - 1) : 0;
    snapped[axis] = 2 * static_cast<std::int64_t>(std::floor(units)) + 1 + half_tile;
  }
  return snapped;
}

}  // namespace octurn
