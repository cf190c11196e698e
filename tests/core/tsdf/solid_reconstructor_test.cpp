#include "tsdf/solid_reconstructor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/rendered.hpp"
#include "mesh/mesh_check.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

ReconstructOptions options(double leaf_size = 0.002) {
  return {.method = Method::solid,
          .leaf_size = leaf_size,
          .clip = {.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}}};
}

std::vector<Facet> part_of(const ReconstructOptions& with, const SnapshotSource& snapshots) {
  SolidReconstructor solid(with);
  solid.add(snapshots);
  std::vector<Facet> facets;
  solid.surface(snapshots, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  return facets;
}

MeshCheck checked(const std::vector<Facet>& facets) {
  MeshCheck check;
  check.add(facets);
  return check;
}

/// The greatest distance of an observed corner from the shape, metres.
/// @param lowest  metres above the platform, below which corners are ignored
double worst_of(const std::vector<Facet>& facets, const Shape& shape, double lowest = 0.006) {
  double worst = 0;
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    for (const auto& corner : corners) {
      const Eigen::Vector3d point = Eigen::Vector3f(corner.data()).cast<double>() / 1000;
      if (facet.attributes != filled_in && point.z() > lowest) {
        worst = std::max(worst, std::abs(shape(point)));
      }
    }
  }
  return worst;
}

TEST(Solid, IsOneClosedPartOnAFlatBase) {
  const std::vector<Facet> facets = part_of(options(), rendered(block({0.06, 0.04, 0.07}), 8));
  const Topology topology = topology_of(facets);
  EXPECT_TRUE(topology.manifold);
  EXPECT_EQ(topology.euler, 2);  // one part without holes: two parts have 4
  EXPECT_EQ(checked(facets).bounds_mm().min.z(), 0.0);
}

TEST(Solid, HasTheVolumeAndTheSurfaceOfABlock) {
  const Shape shape = block({0.06, 0.04, 0.07});
  const std::vector<Facet> facets = part_of(options(), rendered(shape, 8));
  const MeshCheck check = checked(facets);
  // 2 % is a tenth of a voxel, 0.18 mm, over the whole surface.
  EXPECT_NEAR(check.volume_mm3(), 60 * 40 * 70, 60 * 40 * 70 * 0.02);
  EXPECT_LT(worst_of(facets, shape), 0.002);  // a voxel, at the rounded edges
  EXPECT_NEAR(check.bounds_mm().max.z(), 70, 0.3);
}

TEST(Solid, StaysOnABall) {
  const Shape shape = ball({0.01, -0.005, 0.05}, 0.045);
  const std::vector<Facet> facets = part_of(options(), rendered(shape, 8));
  ASSERT_GT(facets.size(), 500U);  // of edges of 5 mm: the area is 250 cm2
  // Samples are 3 mm apart: planes fitted to five of them lie up to 6^2 / (2 * 45) = 0.4 mm inside
  // the ball. At grazing incidence the window on the ball is wider, and the error three times that.
  EXPECT_LT(worst_of(facets, shape, 0.022), 0.0012);
  // Below the ball, single snapshots see past it onto the platform, and no snapshot alone makes
  // space free. There the observed surface passes into the filled one within a voxel.
  EXPECT_LT(worst_of(facets, shape), 0.002);
}

TEST(Solid, KeepsWhatIsHollowHollow) {
  const Shape shape = hollowed_block({0.12, 0.1, 0.05}, 0.03);
  const std::vector<Facet> facets = part_of(options(), rendered(shape, 8));
  const double volume = 120 * 100 * 50 - 2.0 / 3 * std::numbers::pi * 30 * 30 * 30;
  EXPECT_NEAR(checked(facets).volume_mm3(), volume, volume * 0.02);  // as of the block
  EXPECT_TRUE(topology_of(facets).manifold);
}

TEST(Solid, DoesNotThickenAThinPlate) {
  const std::vector<Facet> facets =
      part_of(options(0.001), rendered(block({0.07, 0.004, 0.06}), 8));
  // 10 % is 0.2 mm on either side, a fifth of a voxel.
  EXPECT_NEAR(checked(facets).volume_mm3(), 70 * 4 * 60, 70 * 4 * 60 * 0.1);
}

TEST(Solid, ReportsTheShareOfTheSurfaceThatIsFilled) {
  const SnapshotSource once = rendered(ball({0, 0, 0.05}, 0.045), 1);
  const SnapshotSource around = rendered(ball({0, 0, 0.05}, 0.045), 8);
  const double half = checked(part_of(options(), once)).filled_share();
  const double whole = checked(part_of(options(), around)).filled_share();
  EXPECT_GT(half, 0.4);
  EXPECT_LT(whole, 0.25);  // the unseen part, near the point that touches the platform
  EXPECT_TRUE(topology_of(part_of(options(), once)).manifold);
}

TEST(Solid, DoesNotFollowAnErrantReading) {
  const SnapshotSource good = rendered(block({0.06, 0.04, 0.07}), 8);
  const SnapshotSource bad{.count = good.count, .read = [&](std::size_t i) {
                             Snapshot snapshot = good.read(i);
                             if (i == 3) {  // a patch of 4 x 4 samples, 4 cm in front of the block
                               for (int v = 75; v < 79; ++v) {
                                 for (int u = 118; u < 122; ++u) {
                                   auto& depth =
                                       snapshot.frame.depth[static_cast<std::size_t>(v * 240 + u)];
                                   depth = static_cast<std::uint16_t>(depth - 400);
                                 }
                               }
                             }
                             return snapshot;
                           }};
  const MeshCheck without = checked(part_of(options(), good));
  const MeshCheck with = checked(part_of(options(), bad));
  EXPECT_NEAR((with.bounds_mm().max - without.bounds_mm().max).norm(), 0, 0.5);
  EXPECT_NEAR((with.bounds_mm().min - without.bounds_mm().min).norm(), 0, 0.5);
}

TEST(Solid, TakesFewerTrianglesForASmallError) {
  const Shape shape = ball({0, 0, 0.05}, 0.045);
  ReconstructOptions all = options();
  all.target_error = 0;
  const std::vector<Facet> many = part_of(all, rendered(shape, 8));
  const std::vector<Facet> few = part_of(options(), rendered(shape, 8));
  EXPECT_LT(few.size() * 3, many.size() * 2);
  EXPECT_LT(worst_of(few, shape), worst_of(many, shape) + 0.0001);
  EXPECT_NEAR(checked(few).volume_mm3(), checked(many).volume_mm3(),
              checked(many).volume_mm3() * 0.001);
  EXPECT_TRUE(topology_of(few).manifold);
  EXPECT_TRUE(topology_of(many).manifold);
}

TEST(Solid, GivesTheSameBytesForAnyThreadsAndMemory) {
  const SnapshotSource snapshots = rendered(hollowed_block({0.08, 0.06, 0.04}, 0.025), 5);
  const std::vector<Facet> alone = part_of(options(), snapshots);
  for (const int threads : {2, 3}) {
    ReconstructOptions with = options();
    with.threads = threads;
    EXPECT_TRUE(same_bytes(part_of(with, snapshots), alone)) << threads << " threads";
    with.memory_limit = std::size_t{52} << 20U;
    EXPECT_TRUE(same_bytes(part_of(with, snapshots), alone)) << threads << " threads, limited";
  }
}

TEST(Solid, GivesTheSameBytesInSlabs) {
  const SnapshotSource all = rendered(block({0.06, 0.05, 0.06}), 4);
  const std::vector<Facet> whole = part_of(options(0.0005), all);
  std::size_t reads = 0;
  const SnapshotSource counted{.count = all.count, .read = [&](std::size_t i) {
                                 ++reads;
                                 return all.read(i);
                               }};
  ReconstructOptions tight = options(0.0005);
  tight.memory_limit = std::size_t{32} << 20U;
  EXPECT_TRUE(same_bytes(part_of(tight, counted), whole));
  EXPECT_GT(reads, all.count);
  tight.threads = 4;  // their buffers would take memory from the volume
  EXPECT_TRUE(same_bytes(part_of(tight, counted), whole));
  tight.threads = 1;

  SolidReconstructor solid(tight);
  solid.add(counted);
  const SurfaceCount first = solid.count(counted);
  EXPECT_EQ(first.facets, whole.size());
  EXPECT_EQ(solid.count(counted).facets, first.facets);
}

TEST(Solid, IsMadeOnceIfItIsCountedFirst) {
  const SnapshotSource all = rendered(block({0.06, 0.05, 0.06}), 4);
  std::size_t reads = 0;
  const SnapshotSource counted{.count = all.count, .read = [&](std::size_t i) {
                                 ++reads;
                                 return all.read(i);
                               }};
  const auto reads_of = [&](double target_error) {
    ReconstructOptions tight = options(0.0005);
    tight.target_error = target_error;
    tight.memory_limit = std::size_t{30} << 20U;
    SolidReconstructor solid(tight);
    solid.add(counted);
    const std::uint64_t facets = solid.count(counted).facets;
    reads = 0;
    std::uint64_t streamed = 0;
    solid.surface(counted, [&](std::span<const Facet> some) { streamed += some.size(); });
    EXPECT_EQ(streamed, facets);
    return reads;
  };
  EXPECT_EQ(reads_of(options().target_error), 0U);  // slabs are built once
  EXPECT_GT(reads_of(0), 0U);                       // 183,000 facets do not fit: slabs are rebuilt
}

TEST(Solid, CountsAnewWhatIsAddedLater) {
  const SnapshotSource snapshots = rendered(hollowed_block({0.08, 0.06, 0.04}, 0.025), 3);
  SolidReconstructor solid(options());
  solid.add(snapshots.read(0));
  const std::uint64_t first = solid.count(snapshots).facets;
  solid.add(snapshots.read(1));
  solid.add(snapshots.read(2));
  EXPECT_NE(solid.count(snapshots).facets, first);
  EXPECT_EQ(solid.count(snapshots).facets, part_of(options(), snapshots).size());
}

TEST(Solid, GivesTheSameBytesOneByOne) {
  const SnapshotSource snapshots = rendered(hollowed_block({0.08, 0.06, 0.04}, 0.025), 3);
  SolidReconstructor solid(options());
  for (std::size_t i = 0; i < snapshots.count; ++i) {
    solid.add(snapshots.read(i));
  }
  std::vector<Facet> facets;
  const SurfaceCount count = solid.surface(snapshots, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  EXPECT_TRUE(same_bytes(facets, part_of(options(), snapshots)));
  EXPECT_EQ(count.facets, facets.size());
  EXPECT_EQ(count.parts, 1U);
  EXPECT_EQ(solid.count(snapshots).facets, facets.size());
}

TEST(Solid, ShowsAPreviewWithTheModelsSurfaceOpenAtItsFoot) {
  const SnapshotSource snapshots = rendered(block({0.06, 0.04, 0.07}), 8);
  SolidReconstructor solid(options());
  solid.add(snapshots);
  const auto preview = [&](double leaf_size, std::uint64_t max_facets) {
    MeshCheck check;
    solid.preview(leaf_size, max_facets, [&](std::span<const Facet> some) { check.add(some); });
    return check;
  };
  const MeshCheck model = checked(part_of(options(), snapshots));
  const MeshCheck fine = preview(0.002, 1'000'000);
  EXPECT_FALSE(fine.closed());
  const Eigen::Array3d beyond = fine.bounds_mm().max - model.bounds_mm().max;
  EXPECT_TRUE((beyond.abs() < 0.5).all()) << beyond;
  EXPECT_GT(fine.bounds_mm().min.z(), 1.0);

  const MeshCheck coarser = preview(0.002, fine.facets() - 1);
  EXPECT_LT(coarser.facets(), fine.facets() / 2);  // a level coarser has about a quarter
  EXPECT_GT(coarser.facets(), fine.facets() / 8);
  EXPECT_EQ(preview(0.0001, 1'000'000).facets(), fine.facets());
}

TEST(Solid, HasNoSurfaceOnAnEmptyPlatform) {
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  EXPECT_TRUE(part_of(options(), rendered(nothing, 4)).empty());
}

TEST(Solid, ClosesWhatIsTallerThanTheClipBox) {
  ReconstructOptions low = options();
  low.clip.max.z() = 0.05;
  const std::vector<Facet> facets = part_of(low, rendered(block({0.06, 0.04, 0.1}), 8));
  EXPECT_TRUE(topology_of(facets).manifold);
  // The block is observed up to the clip box's top, within a voxel. Filling continues it at most
  // to the bottom of the next brick above, as that border brick is free.
  const double voxel = 1000.0 / 512;
  const double brick = 8 * voxel;
  EXPECT_GT(checked(facets).bounds_mm().max.z(), 50 - voxel);
  EXPECT_LE(checked(facets).bounds_mm().max.z(), (std::floor(50 / brick) + 1) * brick);
}

TEST(Solid, SaysWhatIsWrongWithItsOptions) {
  const auto thrown_by = [](auto change) {
    ReconstructOptions with = options();
    change(with);
    return code_thrown_by([&] { const SolidReconstructor solid(with); });
  };
  EXPECT_EQ(thrown_by([](auto& o) { o.leaf_size = 0; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.target_error = -1; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.target_error = std::nan(""); }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.level = 3; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.memory_limit = 1; }), "memory-limit");
}

TEST(Solid, SaysWhatMemoryItNeeds) {
  ReconstructOptions with = options(0.0005);
  with.memory_limit = std::size_t{22} << 20U;
  EXPECT_EQ(code_thrown_by([&] {
              part_of(with, rendered(block({0.1, 0.1, 0.1}), 4));
            }),
            "memory-limit");
}

}  // namespace
}  // namespace octurn
