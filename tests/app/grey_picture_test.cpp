#include "camera/grey_picture.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes luminance_of(const Bytes& bytes, PixelLayout layout, std::size_t stride) {
  const Picture picture =
      grey_picture(bytes, {.layout = layout, .width = 2, .height = 2, .stride = stride});
  EXPECT_EQ(picture.width, 2);
  EXPECT_EQ(picture.height, 2);
  return picture.samples;
}

TEST(GreyPicture, LeavesOutWhatFollowsARow) {
  EXPECT_EQ(luminance_of({1, 2, 99, 3, 4, 99}, PixelLayout::grey, 3), (Bytes{1, 2, 3, 4}));
  EXPECT_EQ(luminance_of({1, 2, 99, 3, 4}, PixelLayout::grey, 3), (Bytes{1, 2, 3, 4}));
}

TEST(GreyPicture, TakesTheLuminanceOfPackedColours) {
  EXPECT_EQ(luminance_of({1, 128, 2, 127, 3, 0, 4, 0}, PixelLayout::yuyv, 4), (Bytes{1, 2, 3, 4}));
  EXPECT_EQ(luminance_of({128, 1, 127, 2, 0, 3, 0, 4}, PixelLayout::uyvy, 4), (Bytes{1, 2, 3, 4}));
}

// ITU-R BT.601: 0.299 red, 0.587 green, 0.114 blue.
TEST(GreyPicture, WeighsColours) {
  const Bytes red_green_blue_white{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};
  EXPECT_EQ(luminance_of(red_green_blue_white, PixelLayout::rgb_bytes, 6),
            (Bytes{76, 150, 29, 255}));
  EXPECT_EQ(luminance_of(red_green_blue_white, PixelLayout::bgr_bytes, 6),
            (Bytes{29, 150, 76, 255}));
}

TEST(GreyPicture, RefusesWhatIsTooShort) {
  EXPECT_THROW(luminance_of({1, 2, 3}, PixelLayout::grey, 2), Error);
  EXPECT_THROW(luminance_of({1, 2, 3, 4}, PixelLayout::grey, 1), Error);
  EXPECT_THROW(luminance_of({1, 2, 3, 4, 5, 6}, PixelLayout::yuyv, 4), Error);
}

}  // namespace
}  // namespace octurn
