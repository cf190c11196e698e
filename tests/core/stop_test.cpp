// A stop request ends a reconstruction in each of its phases. The tests count work instead of
// measuring time: no phase after the request does any.

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <stop_token>

#include "core/tsdf/random_field.hpp"
#include "core/tsdf/rendered.hpp"
#include "mesh/stream_simplifier.hpp"
#include "octurn/model.hpp"
#include "octurn/reconstruct.hpp"
#include "support/temporary_folder.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/marching_cubes.hpp"
#include "voxel/connected_components.hpp"

namespace octurn {
namespace {

const Box clip_box{.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}};

std::stop_token stopped_token() {
  std::stop_source source;
  source.request_stop();
  return source.get_token();
}

struct MethodAndThreads {
  Method method = Method::solid;
  int threads = 1;
};

class StoppedReconstruction : public testing::TestWithParam<MethodAndThreads> {
 protected:
  static constexpr std::size_t count = 6;

  /// Six snapshots of a block; reading the one with index `last` requests a stop.
  SnapshotSource stopping_at(std::size_t last) {
    return {.count = count, .read = [=, this](std::size_t i) {
              ++reads_;
              if (i == last) {
                stop_.request_stop();
              }
              return all_.read(i);
            }};
  }

  SnapshotSource all_ = rendered(block({0.06, 0.04, 0.07}), count);
  std::stop_source stop_ = {};
  std::atomic<std::size_t> reads_ = 0;
  ReconstructOptions options_{.method = GetParam().method,
                              .leaf_size = 0.002,
                              .clip = clip_box,
                              .threads = GetParam().threads};
};

TEST_P(StoppedReconstruction, ReadsNoFurtherSnapshot) {
  const auto reconstructor = make_reconstructor(options_);
  EXPECT_THROW(reconstructor->add(stopping_at(2), stop_.get_token()), Stopped);
  // Each other thread may have begun one more snapshot.
  EXPECT_LE(reads_, 3U + static_cast<std::size_t>(GetParam().threads) - 1);
}

TEST_P(StoppedReconstruction, AddsNothing) {
  const auto reconstructor = make_reconstructor(options_);
  EXPECT_THROW(reconstructor->add(all_.read(0), stopped_token()), Stopped);
  const SnapshotSource none{};
  EXPECT_EQ(reconstructor->count(none).facets, 0U);
}

TEST_P(StoppedReconstruction, MakesNoFacet) {
  const auto reconstructor = make_reconstructor(options_);
  reconstructor->add(all_);
  const auto refuse = [](std::span<const Facet>) { FAIL() << "a facet after the stop"; };
  EXPECT_THROW(reconstructor->surface(all_, refuse, stopped_token()), Stopped);
  EXPECT_THROW(reconstructor->preview(0.002, 1'000'000, refuse, stopped_token()), Stopped);
  EXPECT_THROW(reconstructor->count(all_, stopped_token()), Stopped);
}

TEST_P(StoppedReconstruction, EndsItsSurfaceAtThePieceInWhichItWasAsked) {
  options_.target_error = 0;  // streams the surface layer by layer
  const auto reconstructor = make_reconstructor(options_);
  reconstructor->add(all_);
  int pieces = 0;
  const auto stop_at_third = [&](std::span<const Facet>) {
    if (++pieces == 3) {
      stop_.request_stop();
    }
  };
  EXPECT_THROW(reconstructor->surface(all_, stop_at_third, stop_.get_token()), Stopped);
  EXPECT_EQ(pieces, 3);
}

TEST_P(StoppedReconstruction, LeavesNoFile) {
  const TemporaryFolder folder;
  const auto reconstructor = make_reconstructor(options_);
  reconstructor->add(all_);
  EXPECT_FALSE(write_model(*reconstructor, all_, folder.path() / "Scan.stl", stopped_token()));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

INSTANTIATE_TEST_SUITE_P(Stop, StoppedReconstruction,
                         testing::Values(MethodAndThreads{Method::solid, 1},
                                         MethodAndThreads{Method::solid, 2},
                                         MethodAndThreads{Method::intersection, 1},
                                         MethodAndThreads{Method::intersection, 2}));

TEST(StoppedSolid, EndsInTheSlabsThatAreReadAgain) {
  const SnapshotSource all = rendered(block({0.06, 0.05, 0.06}), 4);
  const auto reconstructor = make_reconstructor({.method = Method::solid,
                                                 .leaf_size = 0.0005,
                                                 .clip = clip_box,
                                                 .memory_limit = std::size_t{32} << 20U});
  reconstructor->add(all);
  std::stop_source stop;
  std::size_t reads = 0;
  const SnapshotSource stops_at_its_last{.count = all.count, .read = [&](std::size_t i) {
                                           if (++reads == all.count) {
                                             stop.request_stop();
                                           }
                                           return all.read(i);
                                         }};
  const auto refuse = [](std::span<const Facet>) { FAIL() << "a facet after the stop"; };
  EXPECT_THROW(reconstructor->surface(stops_at_its_last, refuse, stop.get_token()), Stopped);
  EXPECT_EQ(reads, all.count);
}

TEST(StoppedPhase, IntegratesNothing) {
  TsdfVolume volume(VoxelGrid(1.0, 9, clip_box, 0.005));
  const auto bricks = [&] {
    int count = 0;
    for (int z = 0; z < volume.grid().size().z; ++z) {
      for (int y = 0; y < volume.grid().size().y; ++y) {
        for (int x = 0; x < volume.grid().size().x; ++x) {
          count += volume.find({x, y, z}) != nullptr ? 1 : 0;
        }
      }
    }
    return count;
  };
  const ConditionedDepth depth(rendered(block({0.06, 0.05, 0.06}), 1).read(0), clip_box);
  EXPECT_THROW(integrate(volume, depth, stopped_token()), Stopped);
  EXPECT_EQ(bricks(), 0);
  integrate(volume, depth);
  EXPECT_GT(bricks(), 0);
}

TEST(StoppedPhase, FillsNothing) {
  const CompactTsdf known = random_field(1, 0.4);
  EXPECT_THROW(HoleFilledSdf(known, 3, stopped_token()), Stopped);
  const HoleFilledSdf filled(known, 3);
  EXPECT_THROW(filled.inside(stopped_token()), Stopped);
}

TEST(StoppedPhase, ChangesNoMask) {
  const CompactTsdf known = random_field(1, 0.4);
  VoxelMask mask = HoleFilledSdf(known, 3).inside();
  const std::uint64_t count = mask.count();
  EXPECT_THROW(keep_main_component(mask, 1, stopped_token()), Stopped);
  EXPECT_THROW(mask.remove_spurs(stopped_token()), Stopped);
  EXPECT_THROW(mask.fill_cavities(stopped_token()), Stopped);
  EXPECT_THROW(mask.component_count(stopped_token()), Stopped);
  EXPECT_EQ(mask.count(), count);
}

TEST(StoppedPhase, CutsNoLayer) {
  const CompactTsdf known = random_field(1, 0.4);
  const HoleFilledSdf filled(known, 3);
  const VoxelMask inside = filled.inside();
  std::stop_source stop;
  int pieces = 0;
  const auto stop_at_second = [&](const MeshPiece&) {
    if (++pieces == 2) {
      stop.request_stop();
    }
  };
  EXPECT_THROW(marching_cubes(inside, filled, stop_at_second, stop.get_token()), Stopped);
  EXPECT_EQ(pieces, 2);
}

TEST(StoppedPhase, CollapsesNoEdge) {
  const CompactTsdf known = random_field(1, 0.4);
  const HoleFilledSdf filled(known, 3);
  const auto refuse = [](std::span<const Facet>) { FAIL() << "a facet after the stop"; };
  StreamSimplifier simplifier(0.5, 1000, refuse, stopped_token());
  EXPECT_THROW(
      {
        marching_cubes(filled.inside(), filled,
                       [&](const MeshPiece& piece) { simplifier.add(piece); });
        simplifier.finish();
      },
      Stopped);
}

}  // namespace
}  // namespace octurn
