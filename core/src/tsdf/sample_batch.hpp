#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "tsdf/sensor_from_voxel.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {

/// The voxels of one block as samples of a snapshot, as a structure of arrays. Samples come in
/// fours, and loops over them have no branches, so that compilers vectorise them.
struct SampleBatch {
  template <typename Value>
  using Each = std::array<Value, TsdfBrick::samples>;

  std::size_t count = 0;                          // a multiple of four
  std::array<int, TsdfBrick::samples / 4> first;  // index in the brick, of the first of four
  std::array<Each<float>, 3> at;                  // sensor's frame, metres
  Each<int> pixel;                                // row-major
  Each<float> distance;                           // to the tangent plane, metres
  Each<float> weight;                             // of the reading; 0: the pixel has no surface
  Each<float> free_space_depth;                   // metres
  Each<int> near;                                 // 1: to be integrated
  Each<int> free;                                 // votes of the ray that passed through, or 0
  int near_count;
  int free_count;
};

/// Samples a snapshot at the voxels of blocks, and averages the distances into bricks.
class BlockSampler {
 public:
  /// @param depth  must outlive this
  BlockSampler(const VoxelGrid& grid, const ConditionedDepth& depth,
               const SensorFromVoxel& sensor_from_voxel);

  /// Fills a new batch with the block whose lowest voxel, counted from the grid's lowest corner, is
  /// `low`.
  void sample(const Index3& low, SampleBatch& batch) const;

  /// Adds the samples that are near a surface to their brick, by a weighted running mean.
  /// @param batch  its distances and weights become ticks
  void average(TsdfBrick& brick, SampleBatch& batch) const;

  /// Index of a sample in its brick.
  std::size_t index_in_brick(const SampleBatch& batch, std::size_t i) const {
    return static_cast<std::size_t>(batch.first[i / 4] + lane_offset_[i % 4]);
  }

 private:
  /// A pinhole camera in single precision.
  struct Camera {
    float fx;
    float fy;
    float cx;
    float cy;
    float last_u;
    float last_v;
    int width;
  };

  void append_rows(const Index3& voxel, SampleBatch& batch) const;
  void project(SampleBatch& batch) const;
  void gather(SampleBatch& batch) const;
  void classify(SampleBatch& batch) const;

  const ConditionedDepth& depth_;
  SensorFromVoxel sensor_from_voxel_;
  Camera camera_;
  float voxel_side_;
  float truncation_;
  int block_voxels_;
  int lanes_along_y_;      // of the four; the others follow along z
  Eigen::Array4f lane_y_;  // voxels from the first one's corner to each lane's centre
  Eigen::Array4f lane_z_;
  std::array<int, 4> lane_offset_ = {};  // in the brick
};

}  // namespace octurn
