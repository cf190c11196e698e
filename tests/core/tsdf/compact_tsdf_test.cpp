#include "tsdf/compact_tsdf.hpp"

#include <gtest/gtest.h>

namespace octurn {
namespace {

/// The state of one sample with that weight and distance.
/// @param free_sample  votes of rays that passed through the sample
/// @param free_block   votes of rays that passed through its block
/// @param min_votes    number of votes from which on space is free
VoxelState state_of(float weight, int distance, int free_sample, int free_block,
                    int min_votes = 1) {
  TsdfVolume volume(
      VoxelGrid(1.0, 9, {.min = {-0.05, -0.05, 0}, .max = {0.05, 0.05, 0.05}}, 0.005));
  const Index3 index{2, 3, 2};
  constexpr std::size_t sample = 5 + 8 * 6 + 64 * 3;
  TsdfBrick& brick = *volume.make(index);
  brick.weight[sample] = pack(weight);
  brick.weight[sample + 1] = pack(1);  // bricks without a surface are dropped
  brick.distance[sample] = static_cast<std::int16_t>(distance);
  brick.free[sample] = static_cast<std::uint8_t>(free_sample);
  const int voxels = volume.grid().block_voxels();
  const Index3 block{(index.x * 8 + 5) / voxels, (index.y * 8 + 6) / voxels,
                     (index.z * 8 + 3) / voxels};
  volume.free_count(block) = static_cast<std::uint8_t>(free_block);
  CompactTsdf known(volume.grid(), min_votes);
  known.add(volume);
  EXPECT_EQ(known.is_free(block), free_block >= min_votes);
  const CompactBrick* const compact = known.find(index);
  EXPECT_NE(compact, nullptr);
  EXPECT_EQ(compact->distance[sample], distance);
  return compact->state(sample);
}

TEST(CompactTsdf, IsUnknownWhereNothingWasObserved) {
  EXPECT_EQ(state_of(0, 0, 0, 0), VoxelState::unknown);
}

TEST(CompactTsdf, IsObservedFromATenthOfAGoodReadingOn) {
  EXPECT_EQ(state_of(0.101F, 500, 0, 0), VoxelState::observed);
  EXPECT_EQ(state_of(0.099F, 500, 0, 0), VoxelState::unknown);
}

TEST(CompactTsdf, IsOccludedWhereAFaintReadingLiesInFront) {
  EXPECT_EQ(state_of(0.05F, -500, 0, 0), VoxelState::occluded);
  EXPECT_EQ(state_of(0, -500, 0, 0), VoxelState::unknown);
}

TEST(CompactTsdf, IsFreeWhereMoreRaysPassedThroughThanItsWeight) {
  EXPECT_EQ(state_of(0, 0, 1, 0), VoxelState::free);
  EXPECT_EQ(state_of(0, 0, 0, 1), VoxelState::free);
  EXPECT_EQ(state_of(2, 100, 2, 2), VoxelState::observed);
  EXPECT_EQ(state_of(2, 100, 3, 2), VoxelState::free);
  EXPECT_EQ(state_of(1.9F, 100, 2, 2), VoxelState::free);
}

TEST(CompactTsdf, IsNotFreeWhereTooFewRaysPassedThrough) {
  EXPECT_EQ(state_of(0, 0, 1, 0, 2), VoxelState::unknown);
  EXPECT_EQ(state_of(0, 0, 0, 2, 2), VoxelState::free);
  EXPECT_EQ(state_of(0, 0, 1, 1, 2), VoxelState::free);
  EXPECT_EQ(state_of(0.2F, 100, 1, 0, 2), VoxelState::observed);
  EXPECT_EQ(state_of(0.2F, 100, 1, 1, 2), VoxelState::free);
}

TEST(CompactTsdf, ForgetsBricksThatWereOnlySeenThrough) {
  TsdfVolume volume(
      VoxelGrid(1.0, 9, {.min = {-0.05, -0.05, 0}, .max = {0.05, 0.05, 0.05}}, 0.005));
  volume.make({2, 3, 2})->free[5] = 4;
  CompactTsdf known(volume.grid());
  known.add(volume);
  EXPECT_EQ(known.find({2, 3, 2}), nullptr);
}

TEST(CompactTsdf, KeepsEachStateOfABrickApart) {
  CompactBrick brick;
  for (std::size_t i = 0; i < TsdfBrick::samples; ++i) {
    brick.set_state(i, static_cast<VoxelState>(i * 7 % 4));
  }
  for (std::size_t i = 0; i < TsdfBrick::samples; ++i) {
    EXPECT_EQ(brick.state(i), static_cast<VoxelState>(i * 7 % 4));
  }
}

}  // namespace
}  // namespace octurn
