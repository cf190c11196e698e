#include "camera/colour_picture.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using Bytes = std::vector<std::uint8_t>;

std::vector<Rgb> colours_of(const std::vector<Bytes>& planes, const PixelRows& rows) {
  std::vector<std::span<const std::uint8_t>> spans(planes.begin(), planes.end());
  return colour_picture(spans, rows);
}

// A red and a blue, and their full-range Y, U, V according to ITU-R BT.601.
constexpr Rgb red = {200, 60, 50};
constexpr std::uint8_t red_y = 101;
constexpr std::uint8_t red_u = 99;
constexpr std::uint8_t red_v = 199;
constexpr Rgb blue = {40, 70, 180};
constexpr std::uint8_t blue_y = 74;
constexpr std::uint8_t blue_u = 188;
constexpr std::uint8_t blue_v = 104;

void expect_near(const Rgb& seen, const Rgb& expected) {
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LE(std::abs(seen[i] - expected[i]), 2)  // half a level of U is one level of blue
        << "channel " << i << ": " << int{seen[i]} << ", not " << int{expected[i]};
  }
}

/// Expects the left half of a picture of 4 x 2 pixels to be red, and the right half blue.
void expect_red_and_blue(const std::vector<Bytes>& planes, PixelLayout layout, std::size_t stride) {
  SCOPED_TRACE(static_cast<int>(layout));
  const auto seen =
      colours_of(planes, {.layout = layout, .width = 4, .height = 2, .stride = stride});
  ASSERT_EQ(seen.size(), 8U);
  for (std::size_t i = 0; i < seen.size(); ++i) {
    expect_near(seen[i], i % 4 < 2 ? red : blue);
  }
}

TEST(ColourPicture, FindsTheDifferencesOfColourInEachLayout) {
  const Bytes luminance{red_y, red_y, blue_y, blue_y, 9, red_y, red_y, blue_y, blue_y, 9};
  const Bytes packed_row{red_y, red_u, red_y, red_v, blue_y, blue_u, blue_y, blue_v};
  const Bytes swapped_row{red_u, red_y, red_v, red_y, blue_u, blue_y, blue_v, blue_y};
  Bytes packed(packed_row);
  packed.insert(packed.end(), packed_row.begin(), packed_row.end());
  Bytes swapped(swapped_row);
  swapped.insert(swapped.end(), swapped_row.begin(), swapped_row.end());

  expect_red_and_blue({packed}, PixelLayout::yuyv, 8);
  expect_red_and_blue({swapped}, PixelLayout::uyvy, 8);
  expect_red_and_blue({luminance, {red_u, red_v, blue_u, blue_v}}, PixelLayout::nv12, 5);
  expect_red_and_blue({luminance, {red_v, red_u, blue_v, blue_u}}, PixelLayout::nv21, 5);
  expect_red_and_blue({luminance, {red_u, blue_u}, {red_v, blue_v}}, PixelLayout::yuv420, 5);
  expect_red_and_blue({luminance, {red_v, blue_v}, {red_u, blue_u}}, PixelLayout::yvu420, 5);
}

TEST(ColourPicture, TakesColoursAsTheyAre) {
  const PixelRows rows{.layout = PixelLayout::rgb_bytes, .width = 2, .height = 1, .stride = 6};
  EXPECT_EQ(colours_of({{1, 2, 3, 4, 5, 6}}, rows), (std::vector<Rgb>{{1, 2, 3}, {4, 5, 6}}));
  const PixelRows swapped{.layout = PixelLayout::bgr_bytes, .width = 2, .height = 1, .stride = 6};
  EXPECT_EQ(colours_of({{1, 2, 3, 4, 5, 6}}, swapped), (std::vector<Rgb>{{3, 2, 1}, {6, 5, 4}}));
}

TEST(ColourPicture, HasNoneWhereThereIsGreyAlone) {
  EXPECT_TRUE(colours_of({{1, 2}}, {.layout = PixelLayout::grey, .width = 2, .height = 1}).empty());
}

// A line is found in the difference of two luminances: the camera's, of the picture with a laser,
// and the one of the stored dark picture's colours. So both must agree for every colour.
TEST(ColourPicture, HasTheLuminanceOfTheCameraWhateverTheColour) {
  int colours = 0;
  for (int y = 0; y < 256; y += 5) {
    for (int u = 0; u < 256; u += 15) {
      for (int v = 0; v < 256; v += 15) {
        const auto at = [](int value) { return static_cast<std::uint8_t>(value); };
        const auto seen =
            colours_of({{at(y), at(u), at(y), at(v)}},
                       {.layout = PixelLayout::yuyv, .width = 2, .height = 1, .stride = 4});
        const auto& [r, g, b] = seen.front();
        EXPECT_NEAR(0.299 * r + 0.587 * g + 0.114 * b, y, 0.55) << y << " " << u << " " << v;
        colours += r != g ? 1 : 0;
      }
    }
  }
  EXPECT_GT(colours, 10'000);
}

TEST(ColourPicture, RefusesWhatIsTooShort) {
  const PixelRows packed{.layout = PixelLayout::yuyv, .width = 2, .height = 2, .stride = 4};
  EXPECT_THROW(colours_of({Bytes(7)}, packed), Error);
  EXPECT_NO_THROW(colours_of({Bytes(8)}, packed));
  const PixelRows planar{.layout = PixelLayout::yuv420, .width = 3, .height = 3, .stride = 4};
  EXPECT_THROW(colours_of({Bytes(12), Bytes(4)}, planar), Error);
  EXPECT_THROW(colours_of({Bytes(12), Bytes(4), Bytes(3)}, planar), Error);
  EXPECT_NO_THROW(colours_of({Bytes(11), Bytes(4), Bytes(4)}, planar));
}

}  // namespace
}  // namespace octurn
