#include "tsdf/sample_batch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "parallel/vector_levels.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/sensor_from_voxel.hpp"

namespace octurn {
namespace {

auto four(SampleBatch::Each<float>& each, std::size_t first) {
  return Eigen::Array4f::Map(&each[first]);
}

}  // namespace

BlockSampler::BlockSampler(const VoxelGrid& grid, const ConditionedDepth& depth,
                           const SensorFromVoxel& sensor_from_voxel)
    : depth_(depth),
      sensor_from_voxel_(sensor_from_voxel),
      camera_{.fx = static_cast<float>(depth.intrinsics().fx),
              .fy = static_cast<float>(depth.intrinsics().fy),
              .cx = static_cast<float>(depth.intrinsics().cx),
              .cy = static_cast<float>(depth.intrinsics().cy),
              .last_u = static_cast<float>(depth.intrinsics().width - 1),
              .last_v = static_cast<float>(depth.intrinsics().height - 1),
              .width = depth.intrinsics().width},
      voxel_side_(static_cast<float>(grid.voxel_side())),
      truncation_(static_cast<float>(grid.truncation())),
      block_voxels_(grid.block_voxels()),
      lanes_along_y_(std::min(grid.block_voxels(), 4)) {
  for (int i = 0; i < 4; ++i) {
    const int y = i % lanes_along_y_;
    const int z = i / lanes_along_y_;
    lane_y_[i] = static_cast<float>(y) + 0.5F;
    lane_z_[i] = static_cast<float>(z) + 0.5F;
    lane_offset_[static_cast<std::size_t>(i)] = (y + z * brick_side) * brick_side;
  }
}

void BlockSampler::sample(const Index3& low, SampleBatch& batch) const {
  for (int z = 0; z < block_voxels_; z += 4 / lanes_along_y_) {
    for (int y = 0; y < block_voxels_; y += lanes_along_y_) {
      append_rows({low.x, low.y + y, low.z + z}, batch);
    }
  }
  project(batch);
  gather(batch);
  classify(batch);
}

/// Appends four rows of voxels along x that begin at `voxel`: side by side along y, or, of the
/// smallest blocks, two by two along y and z.
void BlockSampler::append_rows(const Index3& voxel, SampleBatch& batch) const {
  const auto& [origin, step] = sensor_from_voxel_;
  const Eigen::Array4f y = static_cast<float>(voxel.y) + lane_y_;
  const Eigen::Array4f z = static_cast<float>(voxel.z) + lane_z_;
  std::array<Eigen::Array4f, 3> p;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float start = origin[axis] + (static_cast<float>(voxel.x) + 0.5F) * step[0][axis];
    p[axis] = start + y * step[1][axis] + z * step[2][axis];
  }
  const int first = voxel.x % brick_side + voxel.y % brick_side * brick_side +
                    voxel.z % brick_side * brick_side * brick_side;
  for (int x = 0; x < block_voxels_; ++x) {
    batch.first[batch.count / 4] = first + x;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      four(batch.at[axis], batch.count) = p[axis];
      p[axis] += step[0][axis];
    }
    batch.count += 4;
  }
}

/// Finds each sample's pixel. Samples outside the image get a pixel at its edge, which has no
/// reading.
OCTURN_VECTOR_LEVELS
void BlockSampler::project(SampleBatch& batch) const {
  const auto [fx, fy, cx, cy, last_u, last_v, width] = camera_;
  const auto& [x, y, z] = batch.at;
  for (std::size_t i = 0; i < batch.count; ++i) {
    const float inverse_depth = 1.0F / larger(z[i], min_z);
    const float u = smaller(larger(x[i] * inverse_depth * fx + cx, 0.0F), last_u);
    const float v = smaller(larger(y[i] * inverse_depth * fy + cy, 0.0F), last_v);
    batch.pixel[i] = nearest_pixel(v) * width + nearest_pixel(u);
  }
}

/// Gathers the pixels' planes, weights and depths. A pixel without a surface has a plane at
/// distance 0.
void BlockSampler::gather(SampleBatch& batch) const {
  for (std::size_t i = 0; i < batch.count; i += 4) {
    const DepthObservation& a = depth_.at(batch.pixel[i]);
    const DepthObservation& b = depth_.at(batch.pixel[i + 1]);
    const DepthObservation& c = depth_.at(batch.pixel[i + 2]);
    const DepthObservation& d = depth_.at(batch.pixel[i + 3]);
    const auto along = [&](std::size_t axis) -> Eigen::Array4f {
      return Eigen::Array4f(a.normal[axis], b.normal[axis], c.normal[axis], d.normal[axis]) *
             four(batch.at[axis], i);
    };
    four(batch.distance, i) =
        along(0) + along(1) + along(2) + Eigen::Array4f(a.offset, b.offset, c.offset, d.offset);
    four(batch.weight, i) = Eigen::Array4f(a.weight, b.weight, c.weight, d.weight);
    four(batch.free_space_depth, i) = Eigen::Array4f(a.free_space_depth, b.free_space_depth,
                                                     c.free_space_depth, d.free_space_depth);
  }
}

/// Marks the samples that are near a surface, and those through which the ray passed.
OCTURN_VECTOR_LEVELS
void BlockSampler::classify(SampleBatch& batch) const {
  int near = 0;
  int free = 0;
  for (std::size_t i = 0; i < batch.count; ++i) {
    const float z = batch.at[2][i];
    const float distance = batch.distance[i];
    const float free_space_depth = batch.free_space_depth[i];
    const int in_front = z > min_z ? 1 : 0;  // of the sensor
    const int surface = batch.weight[i] > 0 ? 1 : 0;
    const int outside = distance >= truncation_ ? 1 : 0;
    const int within = std::abs(distance) < truncation_ ? 1 : 0;
    const int not_deep = z < free_space_depth + max_behind * truncation_ ? 1 : 0;
    const int before = z < free_space_depth - truncation_ ? 1 : 0;
    const int far_before = z < free_space_depth - free_margin * truncation_ ? 1 : 0;
    batch.near[i] = in_front & surface & within & not_deep;
    const int passed = in_front & ((outside & before) | ((surface ^ 1) & far_before));
    batch.free[i] =
        passed * (votes_of_any_ray + surface * (votes_of_surface_ray - votes_of_any_ray));
    near += batch.near[i];
    free += passed;
  }
  batch.near_count = near;
  batch.free_count = free;
}

void BlockSampler::average(TsdfBrick& brick, SampleBatch& batch) const {
  static_assert(falloff_power == 3);
  constexpr float min_weight = 1.0F / 2048;
  for (std::size_t i = 0; i < batch.count; i += 4) {
    const Eigen::Array4f distance = four(batch.distance, i);
    const Eigen::Array4f behind = (-distance - voxel_side_).max(0.0F);
    const Eigen::Array4f left = (1 - behind / (truncation_ - voxel_side_)).max(0.0F);
    four(batch.weight, i) *= left * left * left;
    four(batch.distance, i) = distance / truncation_ * TsdfVolume::ticks;
  }
  for (std::size_t i = 0; i < batch.count; ++i) {
    const float added = batch.weight[i];
    if (batch.near[i] == 0 || added < min_weight) {
      continue;
    }
    std::int16_t& distance = brick.distance[index_in_brick(batch, i)];
    PackedWeight& weight = brick.weight[index_in_brick(batch, i)];
    const float had = unpack(weight);
    const float mean =
        (static_cast<float>(distance) * had + batch.distance[i] * added) / (had + added);
    distance = static_cast<std::int16_t>(static_cast<int>(mean + 32768.5F) - 32768);
    weight = pack(had + added);
  }
}

}  // namespace octurn
