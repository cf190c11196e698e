#include "bennett/pseudo_voxels.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

namespace octurn {
namespace {

constexpr Brick no_leaves{};

/// The bricks of one layer of an octree, and those of the layer above that have leaves at their
/// bottom, which is all that a slab keeps of them.
std::vector<PlacedBrick> corner_bricks(const Octree& octree, int layer) {
  std::vector<PlacedBrick> bricks;
  for (int up = 0; up < 2; ++up) {
    octree.for_each_brick(layer + up, [&](const Index3& position, const Brick& brick) {
      if (up == 0 || brick.layers[0] != 0) {
        bricks.push_back({position, &brick});
      }
    });
  }
  return bricks;
}

}  // namespace

/// Bricks contributing corners to one layer's pseudo-voxels: those of the layer itself and of the
/// layer above.
class CornerBricks {
 public:
  CornerBricks(int layer, std::vector<PlacedBrick> bricks)
      : layer_(layer), bricks_(std::move(bricks)), by_row_(bricks_) {
    std::ranges::sort(by_row_, {}, [](const PlacedBrick& found) {
      return std::tuple(found.position.y, found.position.z, found.position.x);
    });
    low_y_ = by_row_.empty() ? 0 : by_row_.front().position.y;
    rows_.resize(by_row_.empty() ? 0 : row_index(by_row_.back().position) + 2);
    for (const PlacedBrick& found : by_row_) {
      ++rows_[row_index(found.position) + 1];
    }
    std::partial_sum(rows_.begin(), rows_.end(), rows_.begin());
  }

  /// Calls `visit(position, up)` for each brick; `up` is 1 for bricks of the layer above, which
  /// come last.
  template <typename Visit>
  void for_each(Visit visit) const {
    for (const PlacedBrick& found : bricks_) {
      visit(found.position, found.position.z - layer_);
    }
  }

  const Brick* find(const Index3& position) const {
    if (position.y < low_y_ || row_index(position) + 1 >= rows_.size()) {
      return nullptr;
    }
    const auto row = std::span(by_row_).subspan(
        rows_[row_index(position)], rows_[row_index(position) + 1] - rows_[row_index(position)]);
    const auto found = std::ranges::lower_bound(
        row, position.x, {}, [](const PlacedBrick& one) { return one.position.x; });
    return found != row.end() && found->position.x == position.x ? found->brick : nullptr;
  }

 private:
  /// Rows along x, of the layer and of the one above in turn.
  std::size_t row_index(const Index3& position) const {
    return 2 * static_cast<std::size_t>(position.y - low_y_) +
           static_cast<std::size_t>(position.z - layer_);
  }

  int layer_;
  std::vector<PlacedBrick> bricks_;
  std::vector<PlacedBrick> by_row_;
  int low_y_ = 0;
  std::vector<std::uint32_t> rows_ =
      {};  // index in `by_row_` of each row's first; one more at the end
};

PseudoVoxelLayer::PseudoVoxelLayer(int layer, std::vector<PlacedBrick> bricks) {
  const CornerBricks corners(layer, std::move(bricks));
  corners.for_each([&](const Index3& brick, int up) {
    for (int corner = 0; corner < 4; ++corner) {
      add(corners, {brick.x - (corner & 1), brick.y - (corner >> 1), layer}, corner + 4 * up);
    }
  });
}

/// Adds the pseudo-voxel brick at `position`, unless one of its bricks before `corner` did so
/// already.
void PseudoVoxelLayer::add(const CornerBricks& bricks, const Index3& position, int corner) {
  PseudoVoxelBrick added{.position = position, .bricks = {}};
  for (int i = 0; i < 8; ++i) {
    const Brick* brick =
        bricks.find({position.x + (i & 1), position.y + (i >> 1 & 1), position.z + (i >> 2)});
    if (brick != nullptr && i < corner) {
      return;
    }
    added.bricks[static_cast<std::size_t>(i)] = brick != nullptr ? brick : &no_leaves;
  }
  bricks_.push_back(added);
}

PseudoVoxelLayer pseudo_voxels(const Octree& octree, int layer) {
  return {layer, corner_bricks(octree, layer)};
}

void PseudoVoxelLayer::sort_by_rows() {
  std::ranges::sort(bricks_, {}, [](const PseudoVoxelBrick& brick) {
    return std::tuple(brick.position.y, brick.position.x);
  });
}

}  // namespace octurn
