#include "octurn/reconstruct.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/mesh/surface.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/error.hpp"
#include "support/ball_scan.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

ReconstructOptions ball_options(double leaf_size) {
  return {.leaf_size = leaf_size,
          .root_size = 1.0,
          .threshold = 0.0001,
          .clip = ball_clip,
          .level = {},
          .threads = 1,
          .memory_limit = 0};
}

std::vector<Facet> surface_of(const ReconstructOptions& options, const SnapshotSource& snapshots) {
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  reconstruction->add(snapshots);
  std::vector<Facet> facets;
  reconstruction->surface(snapshots, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  return facets;
}

TEST(Reconstruction, StaysWithinALeafOfTheBall) {
  const std::vector<Facet> facets = surface_of(ball_options(0.002), ball_scan(8));
  ASSERT_GT(facets.size(), 10000U);
  // The surface may lie anywhere in a leaf, and the leaf's facets reach half a leaf beyond its
  // centre on each axis. Triangles between samples 4 mm apart lie up to 4^2 / (8 * 50) = 0.04 mm
  // inside.
  const double leaf = 1.0 / 512;
  const double slack = leaf * std::sqrt(3.0) + 0.0001;
  for (const Facet& facet : facets) {
    for (const auto& corner : std::array(facet.corners)) {
      const Eigen::Vector3d metres = Eigen::Vector3f(corner.data()).cast<double>() / 1000;
      EXPECT_NEAR((metres - ball_centre).norm(), ball_radius, slack);
    }
  }
}

TEST(Reconstruction, IsClosed) {
  MeshCheck check;
  check.add(surface_of(ball_options(0.004), ball_scan(4)));
  EXPECT_TRUE(check.closed());
}

TEST(Reconstruction, OfOneLevelCoarserIsThatOfTwiceTheLeafSize) {
  ReconstructOptions coarser = ball_options(0.002);
  coarser.level = 8;
  EXPECT_TRUE(
      same_bytes(surface_of(coarser, ball_scan(3)), surface_of(ball_options(0.004), ball_scan(3))));
}

TEST(Reconstruction, GivesTheSameBytesForAnyNumberOfThreads) {
  const std::vector<Facet> alone = surface_of(ball_options(0.002), ball_scan(5));
  for (const int threads : {2, 3, 8}) {
    ReconstructOptions options = ball_options(0.002);
    options.threads = threads;
    EXPECT_TRUE(same_bytes(surface_of(options, ball_scan(5)), alone)) << threads << " threads";
  }
}

TEST(Reconstruction, GivesTheSameBytesInSlabs) {
  ReconstructOptions options = ball_options(0.00025);
  const SnapshotSource snapshots = ball_scan(3);
  const std::vector<Facet> whole = surface_of(options, snapshots);

  std::atomic<std::size_t> reads = 0;
  const SnapshotSource counted{.count = snapshots.count, .read = [&](std::size_t i) {
                                 ++reads;
                                 return snapshots.read(i);
                               }};
  options.threads = 2;
  options.memory_limit = std::size_t{7} << 20U;
  EXPECT_TRUE(same_bytes(surface_of(options, counted), whole));
  EXPECT_GT(reads, snapshots.count);  // it took more than one slab
}

TEST(Reconstruction, CountsWhatItWillGiveAlsoInSlabs) {
  ReconstructOptions options = ball_options(0.00025);
  options.memory_limit = std::size_t{7} << 20U;
  const SnapshotSource snapshots = ball_scan(2);
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  reconstruction->add(snapshots);
  const SurfaceCount expected = reconstruction->count(snapshots);
  std::uint64_t facets = 0;
  const SurfaceCount count = reconstruction->surface(
      snapshots, [&](std::span<const Facet> some) { facets += some.size(); });
  EXPECT_EQ(facets, expected.facets);
  EXPECT_EQ(count.facets, expected.facets);
  EXPECT_EQ(count.leaves, expected.leaves);
}

TEST(Reconstruction, ShowsACoarsePreviewOfWhatWasSeenSoFar) {
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(ball_options(0.001));
  const auto preview = [&](std::uint64_t max_facets) {
    MeshCheck check;
    reconstruction->preview(0.008, max_facets,
                            [&](std::span<const Facet> facets) { check.add(facets); });
    return check;
  };
  reconstruction->add(ball_snapshot(0));
  const MeshCheck half = preview(1'000'000);
  EXPECT_TRUE(half.closed());
  EXPECT_LT(half.facets(), 3000U);
  reconstruction->add(ball_snapshot(std::numbers::pi));
  const MeshCheck both = preview(1'000'000);
  EXPECT_GT(both.volume_mm3(), half.volume_mm3() * 1.3);

  const MeshCheck coarser = preview(both.facets() - 1);
  EXPECT_TRUE(coarser.closed());
  EXPECT_LT(coarser.facets(), both.facets() / 2);  // a level coarser has about a quarter
  EXPECT_GT(coarser.facets(), both.facets() / 8);
}

TEST(Reconstruction, SaysWhatIsWrongWithItsOptions) {
  const auto thrown_by = [](auto change) {
    ReconstructOptions options = ball_options(0.001);
    change(options);
    return code_thrown_by([&] { make_reconstructor(options); });
  };
  const double nan = std::nan("");
  EXPECT_EQ(thrown_by([](auto& o) { o.leaf_size = 0; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.leaf_size = -1; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.leaf_size = 1.5; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.leaf_size = 1e-6; }), "bad-settings");
  EXPECT_EQ(thrown_by([&](auto& o) { o.leaf_size = nan; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.root_size = 0; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.threshold = 0; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.clip.min = o.clip.max; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.level = 11; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.level = -1; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.threads = 0; }), "bad-settings");
  EXPECT_EQ(thrown_by([](auto& o) { o.memory_limit = 1; }), "memory-limit");
}

}  // namespace
}  // namespace octurn
