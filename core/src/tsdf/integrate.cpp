#include "tsdf/integrate.hpp"

#include <algorithm>

#include "octurn/snapshot.hpp"
#include "tsdf/node_classifier.hpp"
#include "tsdf/sample_batch.hpp"

namespace octurn {
namespace {

constexpr int brick_side = VoxelGrid::brick_side;
constexpr int root_bricks = 8;  // along a side of the largest nodes

void increment(std::uint8_t& counter, int by = 1) {
  counter = static_cast<std::uint8_t>(counter + (counter < 255 ? by : 0));
}

class TsdfIntegrator {
 public:
  TsdfIntegrator(TsdfVolume& volume, const ConditionedDepth& depth, const std::stop_token& stop)
      : volume_(volume),
        grid_(volume.grid()),
        sensor_from_voxel_(grid_, depth),
        classifier_(grid_, depth, sensor_from_voxel_),
        sampler_(grid_, depth, sensor_from_voxel_),
        stop_(stop) {}

  void run() {
    const Index3& size = grid_.size();
    for (int z = 0; z < size.z; z += root_bricks) {
      for (int y = 0; y < size.y; y += root_bricks) {
        for (int x = 0; x < size.x; x += root_bricks) {
          descend({x, y, z}, root_bricks);
        }
      }
    }
  }

 private:
  /// @param bricks  along the node's side
  void descend(const Index3& brick, int bricks) {
    const Index3& size = grid_.size();
    const BrickLayers& layers = volume_.layers();
    if (brick.x >= size.x || brick.y >= size.y || brick.z >= layers.end ||
        brick.z + bricks <= layers.low) {
      return;
    }
    switch (classifier_.classify({brick.x * brick_side, brick.y * brick_side, brick.z * brick_side},
                                 bricks * brick_side)) {
      case NodeClass::outside:
        return;
      case NodeClass::free:
        count_free(brick, bricks);
        return;
      case NodeClass::partial:
      case NodeClass::near_surface:
        break;
    }
    if (bricks == 1) {
      throw_if_stopped(stop_);
      integrate_brick(brick);
      return;
    }
    const int half = bricks / 2;
    for (int child = 0; child < 8; ++child) {
      descend({brick.x + (child & 1) * half, brick.y + (child >> 1 & 1) * half,
               brick.z + (child >> 2) * half},
              half);
    }
  }

  /// Counts all blocks of a node as seen through.
  void count_free(const Index3& brick, int bricks) {
    const int per_brick = grid_.blocks_per_brick();
    const Index3& size = grid_.size();
    const int end_x = std::min(brick.x + bricks, size.x) * per_brick;
    const int end_y = std::min(brick.y + bricks, size.y) * per_brick;
    const int low_z = std::max(brick.z, volume_.layers().low) * per_brick;
    const int end_z = std::min(brick.z + bricks, volume_.layers().end) * per_brick;
    for (int z = low_z; z < end_z; ++z) {
      for (int y = brick.y * per_brick; y < end_y; ++y) {
        for (int x = brick.x * per_brick; x < end_x; ++x) {
          increment(volume_.free_count({x, y, z}));
        }
      }
    }
  }

  void integrate_brick(const Index3& brick) {
    if (grid_.is_border(brick)) {
      return;
    }
    const int per_brick = grid_.blocks_per_brick();
    const int voxels = grid_.block_voxels();
    TsdfBrick* samples = volume_.find(brick);
    for (int z = 0; z < per_brick; ++z) {
      for (int y = 0; y < per_brick; ++y) {
        for (int x = 0; x < per_brick; ++x) {
          const Index3 block{brick.x * per_brick + x, brick.y * per_brick + y,
                             brick.z * per_brick + z};
          const NodeClass node =
              classifier_.classify({block.x * voxels, block.y * voxels, block.z * voxels}, voxels);
          if (node == NodeClass::free) {
            increment(volume_.free_count(block));
          } else if (node == NodeClass::near_surface) {
            integrate_block(brick, block, samples);
          }
        }
      }
    }
  }

  /// @param samples  the brick's, or null; made where a voxel is near a surface
  void integrate_block(const Index3& brick, const Index3& block, TsdfBrick*& samples) {
    const int voxels = grid_.block_voxels();
    SampleBatch batch;
    sampler_.sample({block.x * voxels, block.y * voxels, block.z * voxels}, batch);
    if (batch.near_count > 0) {
      if (samples == nullptr) {
        samples = volume_.make(brick);
      }
      if (samples != nullptr) {
        sampler_.average(*samples, batch);
      }
    }
    if (batch.free_count == static_cast<int>(batch.count)) {
      increment(volume_.free_count(block));
    } else if (batch.free_count > 0 && samples != nullptr) {
      for (std::size_t i = 0; i < batch.count; ++i) {
        increment(samples->free[sampler_.index_in_brick(batch, i)], batch.free[i]);
      }
    }
  }

  TsdfVolume& volume_;
  const VoxelGrid& grid_;
  SensorFromVoxel sensor_from_voxel_;
  NodeClassifier classifier_;
  BlockSampler sampler_;
  const std::stop_token& stop_;
};

}  // namespace

void integrate(TsdfVolume& volume, const ConditionedDepth& depth, const std::stop_token& stop) {
  TsdfIntegrator(volume, depth, stop).run();
}

}  // namespace octurn
