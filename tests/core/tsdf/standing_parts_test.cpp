#include "tsdf/standing_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/rendered.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/model.hpp"
#include "octurn/units.hpp"
#include "support/random.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/solid_reconstructor.hpp"

namespace octurn {
namespace {

constexpr double leaf_size = 0.002;  // metres
constexpr int levels = 9;            // at which a root of 1 m has leaves below that size
constexpr double ball_radius = 0.045;

Box make_clip(double bottom) { return {.min = {-0.14, -0.14, bottom}, .max = {0.14, 0.14, 0.4}}; }

struct Made {
  std::vector<Facet> facets = {};
  SurfaceCount count = {};
};

Made make(const SnapshotSource& snapshots, Parts parts, double bottom = 0.002) {
  SolidReconstructor solid({.method = Method::solid,
                            .leaf_size = leaf_size,
                            .clip = make_clip(bottom),
                            .solid = {.parts = parts}});
  solid.add(snapshots);
  Made made;
  made.count = solid.surface(snapshots, [&](std::span<const Facet> some) {
    made.facets.insert(made.facets.end(), some.begin(), some.end());
  });
  return made;
}

MeshCheck check(const Made& made) {
  MeshCheck check;
  check.add(made.facets);
  return check;
}

/// A block on the axis, and one beside the axis with an eighth of its volume.
SnapshotSource two_blocks(std::size_t count) {
  const Shape large = block({0.06, 0.04, 0.05});
  const Shape small = block({0.02, 0.03, 0.025});
  return rendered(
      [=](const Eigen::Vector3d& p) {
        return std::min(large(p - Eigen::Vector3d(-0.04, 0, 0)),
                        small(p - Eigen::Vector3d(0.05, 0.01, 0)));
      },
      count);
}

/// A ball on the platform, seen by a sensor with errors of up to 4 mm.
SnapshotSource noisy_ball(std::size_t count) {
  return {.count = count,
          .read = [clean = rendered(ball({0, 0, ball_radius}, ball_radius), count)](std::size_t i) {
            Snapshot snapshot = clean.read(i);
            Random random(static_cast<std::uint32_t>(i + 1));
            for (std::uint16_t& depth : snapshot.frame.depth) {
              depth = static_cast<std::uint16_t>(depth + random.between(-40, 40));
            }
            return snapshot;
          }};
}

TEST(StandingParts, AreTheObjectAndWhatIsLeftOutIsCounted) {
  const Made made = make(two_blocks(8), Parts::main);
  EXPECT_EQ(topology_of(made.facets).euler, 2);
  EXPECT_EQ(made.count.parts, 1U);
  EXPECT_EQ(made.count.dropped_parts, make(two_blocks(8), Parts::all).count.dropped_parts + 1);
  const ModelReport report = make_report(made.count, check(made));
  EXPECT_NEAR(cm3_from_m3(report.volume), 6 * 4 * 5, 6 * 4 * 5 * 0.03);
  EXPECT_NEAR(cm3_from_m3(report.dropped.volume), 2 * 3 * 2.5, 2 * 3 * 2.5 * 0.1);
}

TEST(StandingParts, AreClosedShellsIfAllAreKept) {
  const Made made = make(two_blocks(8), Parts::all);
  const Topology topology = topology_of(made.facets);
  EXPECT_TRUE(topology.manifold);
  EXPECT_EQ(topology.euler, 4);  // two shells without holes
  EXPECT_EQ(made.count.parts, 2U);
  EXPECT_LT(made.count.dropped_leaves, 20U);  // isolated voxels only
  const double volume = 60 * 40 * 50 + 20 * 30 * 25;
  EXPECT_NEAR(check(made).volume_mm3(), volume, volume * 0.03);
}

TEST(StandingParts, ReachThePlatformWhereNobodySawTheirFoot) {
  constexpr double bottom = 0.001;
  const SnapshotSource snapshots = noisy_ball(4);
  const VoxelGrid grid(1.0, levels, make_clip(bottom), 0.005, 0);
  TsdfVolume volume(grid);
  for (std::size_t i = 0; i < snapshots.count; ++i) {
    integrate(volume, ConditionedDepth(snapshots.read(i), make_clip(bottom)));
  }
  CompactTsdf known(grid, votes_of_surface_ray);
  known.add(volume);
  const HoleFilledSdf sdf(known, 1);
  VoxelMask hovers = sdf.inside();
  keep_main_component(hovers, 6);
  const auto is_set = [](std::uint64_t word) { return word != 0; };
  const auto reaches_down = [&](const VoxelMask& mask) {
    bool any = false;
    for (int y = 0; y < mask.size().y; ++y) {
      any = any || std::ranges::any_of(mask.row(y, 0), is_set);
    }
    return any;
  };
  ASSERT_FALSE(reaches_down(hovers));
  EXPECT_TRUE(reaches_down(standing_parts(sdf, Parts::main).mask));

  const Made made = make(snapshots, Parts::main, bottom);
  EXPECT_TRUE(topology_of(made.facets).manifold);
  EXPECT_EQ(check(made).bounds_mm().min.z(), 0);
  // Rays at 25 degrees or more leave a cone frustum below the ball unobserved, 2 % of its volume.
  // Noise adds 4 %: 0.6 mm over the ball's surface, a third of a voxel.
  const double ball_mm3 = 4.0 / 3 * std::numbers::pi * 45 * 45 * 45;
  EXPECT_NEAR(check(made).volume_mm3(), ball_mm3, 0.06 * ball_mm3);
  EXPECT_EQ(make(snapshots, Parts::all, bottom).count.parts, 1U);
}

TEST(StandingParts, HaveNoFootWhereRaysPassedBelow) {
  // The ball floats 25 mm above the platform, which the sensor sees below it.
  const Made made = make(rendered(ball({0, 0, 0.045}, 0.02), 8), Parts::main);
  EXPECT_GT(check(made).bounds_mm().min.z(), 15);
}

}  // namespace
}  // namespace octurn
