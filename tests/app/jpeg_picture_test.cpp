#include "camera/jpeg_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "camera/colour_picture.hpp"
#include "support/jpeg.hpp"

namespace octurn {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr int width = 37;  // odd, and no multiple of a block's 8 pixels
constexpr int height = 21;

Picture waves() {
  Picture picture{.width = width, .height = height};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture.samples.push_back(static_cast<std::uint8_t>(60 + 5 * (x % 16) + 4 * (y % 8)));
    }
  }
  return picture;
}

int worst_difference(const Bytes& a, const Bytes& b) {
  int worst = a.size() == b.size() ? 0 : 256;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    worst = std::max(worst, std::abs(a[i] - b[i]));
  }
  return worst;
}

std::vector<Rgb> colours_of(const JpegPlanes& jpeg) {
  const std::vector<std::span<const std::uint8_t>> planes(jpeg.planes.begin(), jpeg.planes.end());
  return colour_picture(planes, jpeg.rows);
}

// At quality 100 coefficients are rounded to integers, which makes a level or two in a pixel.
TEST(JpegPicture, HasTheLuminanceThatTheCameraSent) {
  for (const int subsampling :
       {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_440, TJSAMP_411, TJSAMP_GRAY}) {
    const Bytes jpeg = jpeg_of(waves(), subsampling, 90, 180);
    const auto picture = grey_jpeg(jpeg, width, height);
    ASSERT_TRUE(picture) << subsampling;
    EXPECT_EQ(picture->width, width);
    EXPECT_EQ(picture->height, height);
    EXPECT_LE(worst_difference(picture->samples, waves().samples), 2) << subsampling;
  }
}

// Lines are found in the difference of a grey and a coloured picture.
TEST(JpegPicture, HasTheSameLuminanceInColourAsInGrey) {
  for (const int subsampling :
       {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_440, TJSAMP_411, TJSAMP_GRAY}) {
    const Bytes jpeg = jpeg_of(waves(), subsampling, 90, 180);
    const auto planes = jpeg_planes(jpeg, width, height);
    ASSERT_TRUE(planes) << subsampling;
    EXPECT_EQ(grey_picture(planes->planes[0], planes->rows).samples,
              grey_jpeg(jpeg, width, height)->samples)
        << subsampling;
  }
}

// ITU-R BT.601 with Y = 100, U = 128 + 30 and V = 128 + 50.
TEST(JpegPicture, HasTheColoursThatTheCameraSent) {
  const Picture flat{
      .width = width, .height = height, .samples = Bytes(std::size_t{width} * height, 100)};
  for (const int subsampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420}) {
    const auto planes = jpeg_planes(jpeg_of(flat, subsampling, 128 + 30, 128 + 50), width, height);
    ASSERT_TRUE(planes);
    const std::vector<Rgb> colours = colours_of(*planes);
    ASSERT_EQ(colours.size(), flat.samples.size());
    for (const Rgb& colour : colours) {
      EXPECT_NEAR(colour[0], 100 + 1.402 * 50, 3) << subsampling;
      EXPECT_NEAR(colour[1], 100 - 0.344 * 30 - 0.714 * 50, 3) << subsampling;
      EXPECT_NEAR(colour[2], 100 + 1.772 * 30, 3) << subsampling;
    }
  }
}

TEST(JpegPicture, HasNoColoursWhereTheyAreAtOtherPixelsOrThereAreNone) {
  for (const int subsampling : {TJSAMP_440, TJSAMP_411, TJSAMP_GRAY}) {
    const auto planes = jpeg_planes(jpeg_of(waves(), subsampling), width, height);
    ASSERT_TRUE(planes);
    EXPECT_TRUE(colours_of(*planes).empty());
  }
}

// Motion JPEG leaves out the standard's tables.
TEST(JpegPicture, NeedsNoHuffmanTables) {
  const Bytes jpeg = jpeg_of(waves(), TJSAMP_422);
  const Bytes motion = without_tables(jpeg);
  ASSERT_LT(motion.size() + 400, jpeg.size());  // two tables of 162 values and two of 12
  const auto picture = grey_jpeg(motion, width, height);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->samples, grey_jpeg(jpeg, width, height)->samples);
}

TEST(JpegPicture, IsWholeWithWhatCamerasAddToIt) {
  const Bytes jpeg = jpeg_of(waves(), TJSAMP_422);
  Bytes padded = jpeg;
  padded.resize(jpeg.size() + 1000);
  EXPECT_TRUE(grey_jpeg(padded, width, height));

  Bytes extraneous = jpeg;
  extraneous.insert(extraneous.end() - 2, {1, 2, 3, 4});
  const auto picture = grey_jpeg(extraneous, width, height);
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->samples, grey_jpeg(jpeg, width, height)->samples);
  EXPECT_TRUE(jpeg_planes(extraneous, width, height));

  Bytes lost = jpeg;
  lost.insert(lost.end() - 2, 100, 1);
  EXPECT_FALSE(grey_jpeg(lost, width, height));
  EXPECT_FALSE(jpeg_planes(lost, width, height));
}

TEST(JpegPicture, IsDamagedWhereverItIsCut) {
  const Bytes jpeg = jpeg_of(waves(), TJSAMP_422);
  for (std::size_t size = 0; size < jpeg.size(); ++size) {
    Bytes cut(jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(grey_jpeg(cut, width, height)) << size;
    EXPECT_FALSE(jpeg_planes(cut, width, height)) << size;
    if (size + 8 < jpeg.size()) {  // the last bits may be padding
      cut.insert(cut.end(), {0xff, 0xd9});
      EXPECT_FALSE(grey_jpeg(cut, width, height)) << size;
    }
  }
}

// The decoder reports only the first problem, which is a harmless one here.
TEST(JpegPicture, IsDamagedIfItIsCutAndHasExtraneousBytes) {
  Bytes jpeg = jpeg_of(waves(), TJSAMP_422);
  jpeg.insert(jpeg.begin() + 2, {1, 2});  // after the first marker
  EXPECT_TRUE(grey_jpeg(jpeg, width, height));
  for (std::size_t size = 2; size < jpeg.size(); ++size) {
    const Bytes cut(jpeg.begin(), jpeg.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_FALSE(grey_jpeg(cut, width, height)) << size;
    EXPECT_FALSE(jpeg_planes(cut, width, height)) << size;
  }
}

// Not every flipped bit is detected, but every result is a picture of the right size or none.
TEST(JpegPicture, SurvivesEveryFlippedBit) {
  const Bytes jpeg = jpeg_of(waves(), TJSAMP_420);
  int refused = 0;
  int kept = 0;
  for (std::size_t bit = 0; bit < 8 * jpeg.size(); ++bit) {
    Bytes flipped = jpeg;
    flipped[bit / 8] = static_cast<std::uint8_t>(flipped[bit / 8] ^ 1U << bit % 8);
    const auto picture = grey_jpeg(flipped, width, height);
    const auto planes = jpeg_planes(flipped, width, height);
    ++(picture ? kept : refused);
    if (picture) {
      ASSERT_EQ(picture->samples.size(), std::size_t{width} * height) << bit;
    }
    if (planes) {
      ASSERT_EQ(grey_picture(planes->planes[0], planes->rows).samples.size(),
                std::size_t{width} * height)
          << bit;
    }
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(kept, 100);
}

TEST(JpegPicture, IsDamagedIfItsSizeIsAnother) {
  const Bytes jpeg = jpeg_of(waves(), TJSAMP_422);
  EXPECT_FALSE(grey_jpeg(jpeg, width + 1, height));
  EXPECT_FALSE(grey_jpeg(jpeg, width, height - 1));
  EXPECT_FALSE(jpeg_planes(jpeg, height, width));
}

}  // namespace
}  // namespace octurn
