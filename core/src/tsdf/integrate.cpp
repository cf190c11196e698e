#include "tsdf/integrate.hpp"

#include <algorithm>
#include <atomic>
#include <optional>

#include "octurn/snapshot.hpp"
#include "parallel/fork_join.hpp"
#include "parallel/ordered_pipeline.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/node_classifier.hpp"
#include "tsdf/sample_batch.hpp"

namespace octurn {
namespace {

constexpr int root_bricks = 8;  // along a side of the largest nodes

/// Adds the votes of rays that passed through, up to 255.
void add_votes(std::uint8_t& count, int votes) {
  count = static_cast<std::uint8_t>(std::min(count + votes, 255));
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

  /// The number of the largest nodes.
  static int root_count(const VoxelGrid& grid) {
    const Index3 roots = count_roots(grid);
    return roots.x * roots.y * roots.z;
  }

  /// Integrates into one of them.
  void run(int root) {
    const Index3 brick = lowest_brick(root);
    visit(brick, root_bricks, classifier_.classify(lowest_voxel(brick), root_bricks * brick_side));
  }

  /// Integrates into an eighth of one of them, as `run` does there.
  void run_octant(int root, int octant) {
    constexpr int half = root_bricks / 2;
    const Index3 brick = lowest_brick(root);
    NodeClass node = classifier_.classify(lowest_voxel(brick), root_bricks * brick_side);
    if (node == NodeClass::partial || node == NodeClass::near_surface) {
      node = classifier_.classify_octants(lowest_voxel(brick),
                                          half * brick_side)[static_cast<std::size_t>(octant)];
    }
    visit(to_octant(brick, half, octant), half, node);
  }

 private:
  static Index3 count_roots(const VoxelGrid& grid) {
    const auto roots = [](int bricks) { return (bricks + root_bricks - 1) / root_bricks; };
    return {roots(grid.size().x), roots(grid.size().y), roots(grid.size().z)};
  }

  Index3 lowest_brick(int root) const {
    const Index3 roots = count_roots(grid_);
    return {root % roots.x * root_bricks, root / roots.x % roots.y * root_bricks,
            root / (roots.x * roots.y) * root_bricks};
  }

  static Index3 lowest_voxel(const Index3& brick) {
    return {brick.x * brick_side, brick.y * brick_side, brick.z * brick_side};
  }

  /// The lowest corner of a cube's octant. @param side  of the octant
  static Index3 to_octant(const Index3& low, int side, int octant) {
    return {low.x + (octant & 1) * side, low.y + (octant >> 1 & 1) * side,
            low.z + (octant >> 2) * side};
  }

  /// @param bricks  along the node's side
  void visit(const Index3& brick, int bricks, NodeClass node) {
    const Index3& size = grid_.size();
    const BrickLayers& layers = volume_.layers();
    if (node == NodeClass::outside || brick.x >= size.x || brick.y >= size.y ||
        brick.z >= layers.end || brick.z + bricks <= layers.low) {
      return;
    }
    if (node == NodeClass::free) {
      count_free(brick, bricks, votes_of_any_ray);
    } else if (node == NodeClass::free_to_surface) {
      count_free(brick, bricks, votes_of_surface_ray);
    } else if (bricks == 1) {
      throw_if_stopped(stop_);
      integrate_brick(brick, node);
    } else {
      const int half = bricks / 2;
      const auto octants = classifier_.classify_octants(lowest_voxel(brick), half * brick_side);
      for (int octant = 0; octant < 8; ++octant) {
        visit(to_octant(brick, half, octant), half, octants[static_cast<std::size_t>(octant)]);
      }
    }
  }

  /// Counts votes for all blocks of a node.
  void count_free(const Index3& brick, int bricks, int votes) {
    const int per_brick = grid_.blocks_per_brick();
    const Index3& size = grid_.size();
    const int end_x = std::min(brick.x + bricks, size.x) * per_brick;
    const int end_y = std::min(brick.y + bricks, size.y) * per_brick;
    const int low_z = std::max(brick.z, volume_.layers().low) * per_brick;
    const int end_z = std::min(brick.z + bricks, volume_.layers().end) * per_brick;
    for (int z = low_z; z < end_z; ++z) {
      for (int y = brick.y * per_brick; y < end_y; ++y) {
        for (int x = brick.x * per_brick; x < end_x; ++x) {
          add_votes(volume_.free_count({x, y, z}), votes);
        }
      }
    }
  }

  void integrate_brick(const Index3& brick, NodeClass node) {
    if (grid_.is_border(brick)) {
      return;
    }
    TsdfBrick* samples = volume_.find(brick);
    const int per_brick = grid_.blocks_per_brick();
    const Index3 lowest{brick.x * per_brick, brick.y * per_brick, brick.z * per_brick};
    if (per_brick == 1) {
      integrate_block(brick, lowest, node, samples);
      return;
    }
    for (int z = 0; z < per_brick; z += 2) {
      for (int y = 0; y < per_brick; y += 2) {
        for (int x = 0; x < per_brick; x += 2) {
          integrate_eight_blocks(brick, {lowest.x + x, lowest.y + y, lowest.z + z}, samples);
        }
      }
    }
  }

  /// @param block  the lowest of them
  void integrate_eight_blocks(const Index3& brick, const Index3& block, TsdfBrick*& samples) {
    const int voxels = grid_.block_voxels();
    const auto octants = classifier_.classify_octants(
        {block.x * voxels, block.y * voxels, block.z * voxels}, voxels);
    for (int octant = 0; octant < 8; ++octant) {
      integrate_block(brick, to_octant(block, 1, octant), octants[static_cast<std::size_t>(octant)],
                      samples);
    }
  }

  /// @param samples  the brick's, or null; made where a voxel is near a surface
  void integrate_block(const Index3& brick, const Index3& block, NodeClass node,
                       TsdfBrick*& samples) {
    if (node == NodeClass::free) {
      add_votes(volume_.free_count(block), votes_of_any_ray);
    } else if (node == NodeClass::free_to_surface) {
      add_votes(volume_.free_count(block), votes_of_surface_ray);
    } else if (node == NodeClass::near_surface) {
      sample_block(brick, block, samples);
    }
  }

  void sample_block(const Index3& brick, const Index3& block, TsdfBrick*& samples) {
    const int voxels = grid_.block_voxels();
    SampleBatch batch;
    sampler_.sample({block.x * voxels, block.y * voxels, block.z * voxels}, batch);
    const bool is_all_free = batch.free_count == static_cast<int>(batch.count);
    // Votes make a brick, too. Otherwise those of snapshots before the first surface would be lost,
    // and the result would depend on the order of the snapshots.
    if (samples == nullptr && (batch.near_count > 0 || (batch.free_count > 0 && !is_all_free))) {
      samples = volume_.make(brick);
    }
    if (batch.near_count > 0 && samples != nullptr) {
      sampler_.average(*samples, batch);
    }
    if (is_all_free) {
      const int votes = *std::min_element(
          batch.free.begin(), batch.free.begin() + static_cast<std::ptrdiff_t>(batch.count));
      add_votes(volume_.free_count(block), votes);
    } else if (batch.free_count > 0 && samples != nullptr) {
      for (std::size_t i = 0; i < batch.count; ++i) {
        add_votes(samples->free[sampler_.index_in_brick(batch, i)], batch.free[i]);
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
  TsdfIntegrator integrator(volume, depth, stop);
  const int roots = TsdfIntegrator::root_count(volume.grid());
  for (int root = 0; root < roots; ++root) {
    integrator.run(root);
  }
}

void integrate(TsdfVolume& volume, std::span<const ConditionedDepth* const> depths,
               ThreadTeam& team, const std::stop_token& stop) {
  // The largest nodes are few, and an object lies in some of them: threads share their octants.
  const int per_root = team.size() > 1 ? 8 : 1;
  const int parts = per_root * TsdfIntegrator::root_count(volume.grid());
  std::atomic<int> next = 0;
  team.run([&](int) {
    std::vector<TsdfIntegrator> integrators;
    integrators.reserve(depths.size());
    for (const ConditionedDepth* depth : depths) {
      integrators.emplace_back(volume, *depth, stop);
    }
    for (int part = next++; part < parts; part = next++) {
      for (TsdfIntegrator& integrator : integrators) {
        if (per_root == 1) {
          integrator.run(part);
        } else {
          integrator.run_octant(part / per_root, part % per_root);
        }
      }
    }
  });
}

namespace {

void integrate_in_parallel(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
                           const std::stop_token& stop) {
  ThreadTeam team(threads);
  const auto at_once = static_cast<std::size_t>(threads);
  for (std::size_t first = 0; first < snapshots.count; first += at_once) {
    const std::size_t count = std::min(at_once, snapshots.count - first);
    std::vector<std::vector<ConditionedDepth>> depths(count);
    team.for_each(static_cast<int>(count), [&](int i) {
      throw_if_stopped(stop);
      const auto index = static_cast<std::size_t>(i);
      depths[index] = snapshots.make(first + index);
    });
    std::vector<const ConditionedDepth*> in_order;
    for (const std::vector<ConditionedDepth>& of_snapshot : depths) {
      for (const ConditionedDepth& depth : of_snapshot) {
        in_order.push_back(&depth);
      }
    }
    integrate(volume, in_order, team, stop);
  }
}

void integrate_in_order(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
                        const std::stop_token& stop) {
  threads = std::clamp(static_cast<int>(snapshots.count), 1, threads);
  auto next = [&, index = std::size_t{0}]() mutable -> std::optional<std::size_t> {
    throw_if_stopped(stop);
    return index < snapshots.count ? std::optional(index++) : std::nullopt;
  };
  OrderedPipeline<decltype(next), std::vector<ConditionedDepth>> pipeline(next, threads);
  fork_join(threads, [&](int) {
    pipeline.run([&](std::size_t index,
                     std::vector<ConditionedDepth>& depths) { depths = snapshots.make(index); },
                 [&](std::vector<ConditionedDepth>& depths) {
                   for (const ConditionedDepth& depth : depths) {
                     integrate(volume, depth, stop);
                   }
                   depths.clear();
                 });
  });
}

}  // namespace

void integrate(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
               const std::stop_token& stop) {
  if (volume.holds_all()) {
    integrate_in_parallel(volume, snapshots, threads, stop);
  } else {
    integrate_in_order(volume, snapshots, threads, stop);
  }
}

}  // namespace octurn
