#include "tsdf/integrate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/tsdf/rendered.hpp"
#include "tsdf/integration_model.hpp"

namespace octurn {
namespace {

/// The expected content of one voxel, computed by plain loops over voxels and snapshots, without
/// bricks, blocks or bounds, in doubles.
struct PlainSample {
  double distance = 0;  // metres
  double weight = 0;
  int free = 0;           // rays that pass through; in a volume, their votes
  int clearly_free = 0;   // rays that go on for more than a block's diagonal
  bool doubtful = false;  // rounding or a conservative bound may give another result
};

/// The share of a reading's weight at a voxel with this signed distance, metres.
double falloff(double distance, double voxel_side, double truncation) {
  const double behind = std::max(0.0, -distance - voxel_side);
  return std::pow(std::max(0.0, 1 - behind / (truncation - voxel_side)), falloff_power);
}

void observe(PlainSample& sample, const Eigen::Vector3d& point, const ConditionedDepth& depth,
             const VoxelGrid& grid) {
  constexpr double doubt = 1e-3;  // pixels, or shares of the truncation
  const double truncation = grid.truncation();
  const double free_margin_m = static_cast<double>(free_margin) * truncation;
  const double max_behind_m = static_cast<double>(max_behind) * truncation;
  const Eigen::Vector3d p = depth.sensor_from_object() * point;
  const Intrinsics& intrinsics = depth.intrinsics();
  const double u = p.x() / p.z() * intrinsics.fx + intrinsics.cx;
  const double v = p.y() / p.z() * intrinsics.fy + intrinsics.cy;
  const auto between_pixels = [](double at) { return std::abs(at - std::floor(at) - 0.5) < doubt; };
  sample.doubtful = sample.doubtful || between_pixels(u) || between_pixels(v);
  const int column = static_cast<int>(std::floor(u + 0.5));
  const int row = static_cast<int>(std::floor(v + 0.5));
  if (column < 0 || row < 0 || column >= intrinsics.width || row >= intrinsics.height) {
    return;
  }
  const DepthObservation& reading = depth.at(column, row);
  const double before = static_cast<double>(reading.free_space_depth) - p.z();  // along the ray
  const double diagonal = grid.block_voxels() * grid.voxel_side() * std::numbers::sqrt3;
  const auto see_through = [&](double min) {
    sample.free += before > min ? 1 : 0;
    sample.clearly_free += before > min + diagonal ? 1 : 0;
  };
  const auto is_near = [&](double a, double b) { return std::abs(a - b) < doubt * truncation; };
  if (reading.weight == 0) {
    see_through(free_margin_m);
    sample.doubtful = sample.doubtful || is_near(before, free_margin_m);
    return;
  }
  double distance = static_cast<double>(reading.offset);
  for (int axis = 0; axis < 3; ++axis) {
    distance += static_cast<double>(reading.normal[static_cast<std::size_t>(axis)]) * p[axis];
  }
  sample.doubtful = sample.doubtful || is_near(std::abs(distance), truncation) ||
                    is_near(before, truncation) || is_near(before, -max_behind_m);
  if (distance >= truncation) {
    see_through(truncation);
  } else if (distance > -truncation && before > -max_behind_m) {
    // At grazing incidence the voxel may lie so far before the surface that its block counts as
    // free.
    sample.doubtful = sample.doubtful || before > free_margin_m;
    const double weight =
        static_cast<double>(reading.weight) * falloff(distance, grid.voxel_side(), truncation);
    if (weight > 0) {
      sample.distance =
          (sample.distance * sample.weight + distance * weight) / (sample.weight + weight);
      sample.weight += weight;
    }
  }
}

class Integrate : public testing::Test {
 protected:
  /// Visits the index of every voxel that a snapshot may write to, from the volume's lowest corner.
  template <typename Visit>
  void for_each_voxel(Visit visit) const {
    const Index3& size = volume_.grid().size();
    for (int z = VoxelGrid::brick_side; z < (size.z - 1) * VoxelGrid::brick_side; ++z) {
      for (int y = VoxelGrid::brick_side; y < (size.y - 1) * VoxelGrid::brick_side; ++y) {
        for (int x = VoxelGrid::brick_side; x < (size.x - 1) * VoxelGrid::brick_side; ++x) {
          visit(Index3{x, y, z});
        }
      }
    }
  }

  Eigen::Vector3d centre(const Index3& voxel) const {
    const Index3& low = volume_.grid().low();
    return {volume_.grid().centre(voxel.x + low.x * VoxelGrid::brick_side, 0),
            volume_.grid().centre(voxel.y + low.y * VoxelGrid::brick_side, 1),
            volume_.grid().centre(voxel.z + low.z * VoxelGrid::brick_side, 2)};
  }

  PlainSample plain(const Index3& voxel) const {
    PlainSample sample;
    for (const ConditionedDepth& depth : depths_) {
      observe(sample, centre(voxel), depth, volume_.grid());
    }
    return sample;
  }

  PlainSample integrated(const Index3& voxel) const {
    PlainSample sample;
    const int block = volume_.grid().block_voxels();
    sample.free = volume_.free_count({voxel.x / block, voxel.y / block, voxel.z / block});
    if (const TsdfBrick* brick = volume_.find({voxel.x / 8, voxel.y / 8, voxel.z / 8})) {
      const auto i = static_cast<std::size_t>(voxel.x % 8 + 8 * (voxel.y % 8) + 64 * (voxel.z % 8));
      sample.distance = brick->distance[i] * volume_.grid().truncation() / TsdfVolume::ticks;
      sample.weight = static_cast<double>(unpack(brick->weight[i]));
      sample.free += brick->free[i];
    }
    return sample;
  }

  static constexpr int shots = 4;
  Box clip_{.min = {-0.05, -0.05, 0.002}, .max = {0.05, 0.05, 0.06}};
  TsdfVolume volume_{VoxelGrid(1.0, 9, clip_, 0.005)};
  std::vector<ConditionedDepth> depths_ = [this] {
    const SnapshotSource source = rendered(hollowed_block({0.07, 0.05, 0.045}, 0.02), shots);
    std::vector<ConditionedDepth> all;
    for (std::size_t i = 0; i < shots; ++i) {
      all.emplace_back(source.read(i), clip_);
      integrate(volume_, all.back());
    }
    return all;
  }();
};

TEST_F(Integrate, AveragesWhatThePlainLoopsAverage) {
  const double tick = volume_.grid().truncation() / TsdfVolume::ticks;
  int compared = 0;
  int doubtful = 0;
  for_each_voxel([&](const Index3& voxel) {
    const PlainSample expected = plain(voxel);
    if (expected.doubtful) {
      ++doubtful;
      return;
    }
    const PlainSample sample = integrated(voxel);
    // Each snapshot rounds the sum of weights to 1/4096 of itself and the mean of distances to a
    // tick, and it skips weights below 1/2048.
    ASSERT_NEAR(sample.weight, expected.weight, shots * (expected.weight / 4096 + 1.0 / 2048));
    if (expected.weight > 0.05) {
      ASSERT_NEAR(sample.distance, expected.distance, 8 * shots * tick);
      ++compared;
    }
  });
  EXPECT_GT(compared, 10000);
  EXPECT_LT(doubtful, compared / 4);
}

TEST_F(Integrate, SeesThroughWhatThePlainLoopsSeeThrough) {
  int seen_through = 0;
  int missed = 0;
  for_each_voxel([&](const Index3& voxel) {
    const PlainSample expected = plain(voxel);
    if (!expected.doubtful) {
      const PlainSample sample = integrated(voxel);
      ASSERT_LE(sample.free, votes_of_surface_ray * expected.free);
      if (expected.clearly_free > 0) {
        ++seen_through;
        missed += sample.free == 0 ? 1 : 0;
      }
    }
  });
  EXPECT_GT(seen_through, 10000);
  // A block that pixels without a reading touch, as along outlines, gets no vote at all.
  EXPECT_LT(missed, seen_through / 8);
}

}  // namespace
}  // namespace octurn
