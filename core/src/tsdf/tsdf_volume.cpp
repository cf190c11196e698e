#include "tsdf/tsdf_volume.hpp"

#include "voxel/memory_limit.hpp"

namespace octurn {

TsdfVolume::TsdfVolume(const VoxelGrid& grid, std::size_t max_bytes)
    : grid_(grid),
      max_bytes_(max_bytes),
      layers_{.low = 0, .end = grid.size().z},
      bricks_(grid.brick_count()),
      free_(grid.block_count()) {}

void TsdfVolume::reset_to_slab(int low, std::size_t max_bytes) {
  max_bytes_ = max_bytes;
  layers_ = {.low = low, .end = grid_.size().z};
  bricks_.clear();
  std::ranges::fill(free_, std::uint8_t{0});
}

bool TsdfVolume::holds_all() const {
  const std::size_t blocks = grid_.brick_count() / BlockPool<TsdfBrick>::block_items + 2;
  const std::size_t tables = bytes() - bricks_.brick_bytes();
  return tables < max_bytes_ && blocks <= (max_bytes_ - tables) / BlockPool<TsdfBrick>::block_bytes;
}

TsdfBrick* TsdfVolume::make(const Index3& brick) {
  const std::size_t index = grid_.brick_index(brick);
  TsdfBrick* const existing = bricks_.find(index);
  if (existing != nullptr) {
    return existing;
  }
  const std::lock_guard lock(making_);
  while (brick.z < layers_.end && bricks_.is_full() &&
         bytes() + BlockPool<TsdfBrick>::block_bytes > max_bytes_) {
    drop_top_layers();
  }
  return brick.z < layers_.end ? &bricks_.add(index) : nullptr;
}

/// Drops layers from the top, until at most half of the bricks are left, or one layer.
void TsdfVolume::drop_top_layers() {
  if (layers_.end - layers_.low <= 1) {
    throw OutOfBudget();
  }
  const auto for_each_in = [&](int z, auto visit) {
    const std::size_t end = grid_.brick_index({0, 0, z + 1});
    for (std::size_t index = grid_.brick_index({0, 0, z}); index < end; ++index) {
      if (bricks_.find(index) != nullptr) {
        visit(index);
      }
    }
  };
  std::size_t all = 0;
  for (int z = layers_.low; z < layers_.end; ++z) {
    for_each_in(z, [&](std::size_t) { ++all; });
  }
  for (std::size_t kept = all; 2 * kept > all && layers_.end - layers_.low > 1;) {
    --layers_.end;
    for_each_in(layers_.end, [&](std::size_t index) {
      bricks_.remove(index);
      --kept;
    });
  }
}

}  // namespace octurn
