#include <gtest/gtest.h>

#include "build/merged_scan.hpp"

namespace octurn {
namespace {

/// A frame with readings in a rectangle only, all of them different.
DepthFrame frame_with(int left, int top, int right, int bottom) {
  DepthFrame frame{.width = 12, .height = 9, .depth = {}};
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const bool is_read = u >= left && u < right && v >= top && v < bottom;
      frame.depth.push_back(static_cast<std::uint16_t>(is_read ? 1000 + 12 * v + u : 0));
    }
  }
  return frame;
}

TEST(KeptFrames, GiveEachImageBackAsItWas) {
  const std::vector<DepthFrame> frames = {frame_with(3, 2, 7, 6), frame_with(0, 0, 12, 9),
                                          frame_with(11, 8, 12, 9), frame_with(0, 0, 0, 0)};
  KeptFrames kept(frames.size(), 1000);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_FALSE(kept.find(i));
    kept.keep(i, frames[i]);
    const auto found = kept.find(i);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->width, frames[i].width);
    EXPECT_EQ(found->height, frames[i].height);
    EXPECT_EQ(found->depth, frames[i].depth);
  }
}

TEST(KeptFrames, TakeNoMoreThanTheyMay) {
  KeptFrames kept(3, 100);
  kept.keep(0, frame_with(2, 2, 7, 7));  // 25 readings, 50 bytes
  kept.keep(1, frame_with(1, 2, 7, 7));  // 60 bytes
  kept.keep(2, frame_with(2, 2, 7, 7));
  EXPECT_TRUE(kept.find(0));
  EXPECT_FALSE(kept.find(1));
  EXPECT_TRUE(kept.find(2));
}

}  // namespace
}  // namespace octurn
