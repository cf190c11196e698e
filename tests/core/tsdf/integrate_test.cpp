#include "tsdf/integrate.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/tsdf/rendered.hpp"

namespace octurn {
namespace {

/// What a field should hold at the centre of a leaf, worked out in the most obvious way: of every
/// leaf, of every snapshot, without bricks, cells or bounds, in doubles.
struct PlainSample {
  double distance = 0;  // metres
  double weight = 0;
  int free = 0;
  int clearly_free = 0;   // by more than a cell's diagonal
  bool doubtful = false;  // rounding, or a bound that is allowed to, could decide otherwise
};

/// How much a reading counts that is this far in front of a sample.
double trust(double distance, double leaf_side, double truncation) {
  const double behind = std::max(0.0, -distance - leaf_side);
  return std::pow(std::max(0.0, 1 - behind / (truncation - leaf_side)), 3);
}

void look(PlainSample& sample, const Eigen::Vector3d& point, const ConditionedDepth& sighting,
          const TsdfVolume& field) {
  constexpr double doubt = 1e-3;  // pixels, and parts of the truncation
  const double truncation = field.truncation();
  const Eigen::Vector3d p = sighting.sensor_from_object() * point;
  const Intrinsics& intrinsics = sighting.intrinsics();
  const double u = p.x() / p.z() * intrinsics.fx + intrinsics.cx;
  const double v = p.y() / p.z() * intrinsics.fy + intrinsics.cy;
  const auto between_pixels = [](double at) { return std::abs(at - std::floor(at) - 0.5) < doubt; };
  sample.doubtful = sample.doubtful || between_pixels(u) || between_pixels(v);
  const int column = static_cast<int>(std::floor(u + 0.5));
  const int row = static_cast<int>(std::floor(v + 0.5));
  if (column < 0 || row < 0 || column >= intrinsics.width || row >= intrinsics.height) {
    return;
  }
  const DepthObservation& sight = sighting.at(column, row);
  const double before = static_cast<double>(sight.free_space_depth) - p.z();  // along the ray
  const double diagonal = field.block_voxels() * field.leaf_side() * std::numbers::sqrt3;
  const auto see_through = [&](double least) {
    sample.free += before > least ? 1 : 0;
    sample.clearly_free += before > least + diagonal ? 1 : 0;
  };
  const auto is_near = [&](double a, double b) { return std::abs(a - b) < doubt * truncation; };
  if (sight.weight == 0) {
    see_through(1.5 * truncation);
    sample.doubtful = sample.doubtful || is_near(before, 1.5 * truncation);
    return;
  }
  double distance = static_cast<double>(sight.offset);
  for (int axis = 0; axis < 3; ++axis) {
    distance += static_cast<double>(sight.normal[static_cast<std::size_t>(axis)]) * p[axis];
  }
  sample.doubtful = sample.doubtful || is_near(std::abs(distance), truncation) ||
                    is_near(before, truncation) || is_near(before, -2.5 * truncation);
  if (distance >= truncation) {
    see_through(truncation);
  } else if (distance > -truncation && before > -2.5 * truncation) {
    // So far before a grazed surface that the cell around may count as free.
    sample.doubtful = sample.doubtful || before > 1.5 * truncation;
    const double weight =
        static_cast<double>(sight.weight) * trust(distance, field.leaf_side(), truncation);
    if (weight > 0) {
      sample.distance =
          (sample.distance * sample.weight + distance * weight) / (sample.weight + weight);
      sample.weight += weight;
    }
  }
}

class Fuse : public testing::Test {
 protected:
  /// Visits every leaf that a snapshot may write to, counted from the field's lowest corner.
  template <typename Visit>
  void for_each_leaf(Visit visit) const {
    const Index3& size = field_.size();
    for (int z = Brick::side; z < (size.z - 1) * Brick::side; ++z) {
      for (int y = Brick::side; y < (size.y - 1) * Brick::side; ++y) {
        for (int x = Brick::side; x < (size.x - 1) * Brick::side; ++x) {
          visit(Index3{x, y, z});
        }
      }
    }
  }

  Eigen::Vector3d centre(const Index3& leaf) const {
    const Index3& low = field_.low();
    return {field_.centre(leaf.x + low.x * Brick::side, 0),
            field_.centre(leaf.y + low.y * Brick::side, 1),
            field_.centre(leaf.z + low.z * Brick::side, 2)};
  }

  PlainSample plain(const Index3& leaf) const {
    PlainSample sample;
    for (const ConditionedDepth& sighting : sightings_) {
      look(sample, centre(leaf), sighting, field_);
    }
    return sample;
  }

  PlainSample fused(const Index3& leaf) const {
    PlainSample sample;
    const int cell = field_.block_voxels();
    sample.free = field_.free_cell({leaf.x / cell, leaf.y / cell, leaf.z / cell});
    if (const TsdfBrick* brick = field_.find({leaf.x / 8, leaf.y / 8, leaf.z / 8})) {
      const auto i = static_cast<std::size_t>(leaf.x % 8 + 8 * (leaf.y % 8) + 64 * (leaf.z % 8));
      sample.distance = brick->distance[i] * field_.truncation() / TsdfVolume::ticks;
      sample.weight = static_cast<double>(brick->weight[i]) / TsdfVolume::weight_ticks;
      sample.free += brick->free[i];
    }
    return sample;
  }

  static constexpr int shots = 4;
  Box clip_{.min = {-0.05, -0.05, 0.002}, .max = {0.05, 0.05, 0.06}};
  TsdfVolume field_{VoxelGrid(1.0, 9, clip_, 0.005)};
  std::vector<ConditionedDepth> sightings_ = [this] {
    const SnapshotSource source = rendered(hollowed_block({0.07, 0.05, 0.045}, 0.02), shots);
    std::vector<ConditionedDepth> all;
    for (std::size_t i = 0; i < shots; ++i) {
      all.emplace_back(source.read(i), clip_);
      fuse(field_, all.back());
    }
    return all;
  }();
};

TEST_F(Fuse, AveragesWhatThePlainLoopsAverage) {
  const double tick = field_.truncation() / TsdfVolume::ticks;
  int compared = 0;
  int doubtful = 0;
  for_each_leaf([&](const Index3& leaf) {
    const PlainSample expected = plain(leaf);
    if (expected.doubtful) {
      ++doubtful;
      return;
    }
    const PlainSample sample = fused(leaf);
    // Each snapshot rounds: the weight to its tick, the mean of distances to its.
    ASSERT_NEAR(sample.weight, expected.weight, 2.0 * shots / TsdfVolume::weight_ticks);
    if (expected.weight > 0.05) {
      ASSERT_NEAR(sample.distance, expected.distance, 8 * shots * tick);
      ++compared;
    }
  });
  EXPECT_GT(compared, 10000);
  EXPECT_LT(doubtful, compared / 4);
}

TEST_F(Fuse, SeesThroughWhatThePlainLoopsSeeThrough) {
  int seen_through = 0;
  int missed = 0;
  for_each_leaf([&](const Index3& leaf) {
    const PlainSample expected = plain(leaf);
    if (!expected.doubtful) {
      const PlainSample sample = fused(leaf);
      ASSERT_LE(sample.free, expected.free);
      if (expected.clearly_free > 0) {
        ++seen_through;
        missed += sample.free == 0 ? 1 : 0;
      }
    }
  });
  EXPECT_GT(seen_through, 10000);
  // Cells that pixels without a reading touch, along outlines, count as free in part: not at all.
  EXPECT_LT(missed, seen_through / 8);
}

}  // namespace
}  // namespace octurn
