// A model depends neither on the order of its snapshots, at any distance of the sensor, nor on one
// faulty snapshot.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "core/tsdf/rendered.hpp"
#include "mesh/mesh_check.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/solid_reconstructor.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {
namespace {

std::vector<Snapshot> read_all(const SnapshotSource& source) {
  std::vector<Snapshot> snapshots;
  for (std::size_t i = 0; i < source.count; ++i) {
    snapshots.push_back(source.read(i));
  }
  return snapshots;
}

/// The snapshots of a scene and a sensor distance scaled by `times`, with errors of up to 2 mm in
/// the readings.
std::vector<Snapshot> scaled(std::vector<Snapshot> snapshots, double times) {
  std::mt19937 random(1);
  for (Snapshot& snapshot : snapshots) {
    snapshot.intrinsics.depth_unit *= times;
    snapshot.object_from_sensor.translation() *= times;
    const int most = static_cast<int>(0.002 / snapshot.intrinsics.depth_unit);
    for (std::uint16_t& depth : snapshot.frame.depth) {
      const int error = static_cast<int>(random() % static_cast<unsigned>(2 * most + 1)) - most;
      depth = static_cast<std::uint16_t>(depth == 0 ? 0 : depth + error);
    }
  }
  return snapshots;
}

/// Fails unless both volumes have the same bricks and votes for free space.
/// @return  the share of observed samples whose distances differ by more than 0.02 mm
double share_that_differs(const TsdfVolume& one, const TsdfVolume& other) {
  const double ticks = 0.00002 / one.grid().truncation() * TsdfVolume::ticks;
  int compared = 0;
  int different = 0;
  const Index3& size = one.grid().size();
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        const TsdfBrick* const a = one.find({x, y, z});
        const TsdfBrick* const b = other.find({x, y, z});
        EXPECT_EQ(a == nullptr, b == nullptr);
        if (a == nullptr || b == nullptr) {
          continue;
        }
        EXPECT_EQ(a->free, b->free);
        for (std::size_t i = 0; i < TsdfBrick::samples; ++i) {
          const bool is_observed = unpack(a->weight[i]) > 0.1F;
          compared += is_observed ? 1 : 0;
          different += is_observed && std::abs(a->distance[i] - b->distance[i]) > ticks ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(compared, 1000);
  return static_cast<double>(different) / std::max(compared, 1);
}

TEST(Order, OfSnapshotsChangesOnlyTheRoundingOfDistances) {
  const std::vector<Snapshot> seen = read_all(rendered(block({0.05, 0.04, 0.05}), 6));
  for (const double distance : {0.28, 0.5, 0.65, 1.2}) {
    SCOPED_TRACE(distance);
    const double times = distance / 0.65;
    const std::vector<Snapshot> snapshots = scaled(seen, times);
    const Box clip{.min = {-0.04 * times, -0.04 * times, 0.002},
                   .max = {0.04 * times, 0.04 * times, 0.06 * times}};
    TsdfVolume forwards(VoxelGrid(1.0, 9, clip, 0.005));
    TsdfVolume backwards(forwards.grid());
    for (std::size_t i = 0; i < snapshots.size(); ++i) {
      integrate(forwards, ConditionedDepth(snapshots[i], clip));
      integrate(backwards, ConditionedDepth(snapshots[snapshots.size() - 1 - i], clip));
    }
    EXPECT_LT(share_that_differs(forwards, backwards), 0.001);
  }
}

double volume_of(const std::vector<Snapshot>& snapshots) {
  SolidReconstructor solid({.method = Method::solid,
                            .leaf_size = 0.002,
                            .clip = {.min = {-0.1, -0.1, 0.002}, .max = {0.1, 0.1, 0.2}}});
  const SnapshotSource source{.count = snapshots.size(),
                              .read = [&](std::size_t i) { return snapshots[i]; }};
  solid.add(source);
  MeshCheck check;
  solid.surface(source, [&](std::span<const Facet> some) { check.add(some); });
  return check.volume_mm3();
}

TEST(Fault, OfOneSnapshotInNineThatSawAnEmptyRoomHollowsNothing) {
  std::vector<Snapshot> snapshots = read_all(rendered(hollowed_block({0.08, 0.06, 0.05}, 0.02), 9));
  const double whole = volume_of(snapshots);
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  snapshots[4].frame = rendered(nothing, 9).read(4).frame;
  EXPECT_NEAR(volume_of(snapshots), whole, 0.01 * whole);
}

}  // namespace
}  // namespace octurn
