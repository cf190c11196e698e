#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "octurn/snapshot.hpp"
#include "support/random.hpp"

namespace octurn {
namespace {

using Depths = std::vector<std::uint16_t>;

DepthFrame row_of(const Depths& depth) {
  return {.width = static_cast<int>(depth.size()), .height = 1, .depth = depth};
}

TEST(MergeFrames, BasicIsTheFirstFrame) {
  const std::array frames{row_of({0, 8000, 8001}), row_of({7000, 9000, 0})};

  EXPECT_EQ(merge_frames(frames, DepthFilter::basic).depth, (Depths{0, 8000, 8001}));
}

TEST(MergeFrames, AverageIsTheMeanOfTheValidReadings) {
  const std::array frames{row_of({0, 8000, 0}), row_of({0, 8010, 9000}), row_of({0, 8020, 9004})};

  EXPECT_EQ(merge_frames(frames, DepthFilter::average).depth, (Depths{0, 8010, 9002}));
}

TEST(MergeFrames, AverageDiscardHasNoReadingWhereAnyFrameHasNone) {
  const std::array frames{row_of({0, 8000, 0}), row_of({0, 8010, 9000}), row_of({0, 8020, 9004})};

  EXPECT_EQ(merge_frames(frames, DepthFilter::average_discard).depth, (Depths{0, 8010, 0}));
}

TEST(MergeFrames, RoundsMeansToTheNearestUnitAndHalvesUp) {
  const std::array halves{row_of({1000}), row_of({1001})};
  const std::array third{row_of({1000}), row_of({1000}), row_of({1001})};
  const std::array two_thirds{row_of({1000}), row_of({1001}), row_of({1001})};

  EXPECT_EQ(merge_frames(halves, DepthFilter::average).depth, Depths{1001});
  EXPECT_EQ(merge_frames(third, DepthFilter::average).depth, Depths{1000});
  EXPECT_EQ(merge_frames(two_thirds, DepthFilter::average).depth, Depths{1001});
}

TEST(MergeFrames, DoesNotOverflowOnTheLargestDepths) {
  const std::vector<DepthFrame> frames(100, row_of({65535}));

  EXPECT_EQ(merge_frames(frames, DepthFilter::average).depth, Depths{65535});
}

TEST(MergeFrames, BringsNoiseDownByTheRootOfTheFrames) {
  // The mean of n readings has a standard deviation of sigma / sqrt(n). Rounding to whole units
  // adds 1/12 to the variance; the bound is five standard deviations of the estimate from 10,000
  // pixels.
  constexpr double sigma = 20.0;  // depth units
  Random random(1);
  std::vector<DepthFrame> frames(10, {.width = 100, .height = 100, .depth = Depths(10'000)});
  for (DepthFrame& frame : frames) {
    for (std::uint16_t& depth : frame.depth) {
      depth = static_cast<std::uint16_t>(8000.0 + sigma * random.normal());
    }
  }

  double squares = 0;
  for (const std::uint16_t depth : merge_frames(frames, DepthFilter::average).depth) {
    squares += (depth - 7999.5) * (depth - 7999.5);  // the conversion above rounds down
  }

  const double expected = sigma * sigma / 10 + 1.0 / 12;
  EXPECT_NEAR(squares / 10'000, expected, expected * 5 * std::sqrt(2.0 / 10'000));
}

TEST(MergeFrames, KeepsTheSizeOfTheFrames) {
  const std::array frames{DepthFrame{.width = 3, .height = 2, .depth = Depths(6, 8000)},
                          DepthFrame{.width = 3, .height = 2, .depth = Depths(6, 8000)}};

  const DepthFrame merged = merge_frames(frames, DepthFilter::average);

  EXPECT_EQ(merged.width, 3);
  EXPECT_EQ(merged.height, 2);
  EXPECT_EQ(merged.depth, Depths(6, 8000));
}

TEST(MergeFrames, RefusesNoFramesAndFramesOfDifferentSizes) {
  const std::array wider{row_of({1, 2}), row_of({1, 2, 3})};
  const std::array turned{DepthFrame{.width = 2, .height = 1, .depth = {1, 2}},
                          DepthFrame{.width = 1, .height = 2, .depth = {1, 2}}};
  const std::array cut{row_of({1, 2}), DepthFrame{.width = 2, .height = 1, .depth = {1}}};

  EXPECT_THROW(merge_frames({}, DepthFilter::basic), std::invalid_argument);
  EXPECT_THROW(merge_frames(wider, DepthFilter::average), std::invalid_argument);
  EXPECT_THROW(merge_frames(turned, DepthFilter::average), std::invalid_argument);
  EXPECT_THROW(merge_frames(cut, DepthFilter::average), std::invalid_argument);
}

TEST(DepthFilter, IsFoundByTheNamesOfTheContract) {
  EXPECT_EQ(depth_filter_named("basic"), DepthFilter::basic);
  EXPECT_EQ(depth_filter_named("average"), DepthFilter::average);
  EXPECT_EQ(depth_filter_named("average-discard"), DepthFilter::average_discard);
  EXPECT_EQ(depth_filter_named("Average"), std::nullopt);
  EXPECT_EQ(depth_filter_named(""), std::nullopt);
}

TEST(DepthFilter, SaysItsName) {
  EXPECT_EQ(to_string(DepthFilter::basic), "basic");
  EXPECT_EQ(to_string(DepthFilter::average), "average");
  EXPECT_EQ(to_string(DepthFilter::average_discard), "average-discard");
}

}  // namespace
}  // namespace octurn
