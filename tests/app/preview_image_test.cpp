#include <gtest/gtest.h>
#include <spng.h>

#include <cmath>
#include <memory>
#include <vector>

#include "http/handlers/system.hpp"

namespace octurn {
namespace {

struct DecodedPreview {
  spng_ihdr header = {};
  std::vector<std::uint8_t> samples = {};
  int at(int x, int y) const { return samples[static_cast<std::size_t>(y * 320 + x)]; }
};

DecodedPreview decoded(const std::string& png) {
  const std::unique_ptr<spng_ctx, void (*)(spng_ctx*)> context(spng_ctx_new(0), spng_ctx_free);
  DecodedPreview picture;
  std::size_t size = 0;
  spng_set_png_buffer(context.get(), png.data(), png.size());
  spng_get_ihdr(context.get(), &picture.header);
  spng_decoded_image_size(context.get(), SPNG_FMT_PNG, &size);
  picture.samples.resize(size);
  EXPECT_EQ(spng_decode_image(context.get(), picture.samples.data(), size, SPNG_FMT_PNG, 0), 0);
  return picture;
}

DepthFrame frame_of(int width, int height, std::uint16_t depth) {
  return {.width = width,
          .height = height,
          .depth = std::vector<std::uint16_t>(static_cast<std::size_t>(width * height), depth)};
}

TEST(PreviewImage, IsGreyOf8BitsAnd320By240) {
  for (const auto& [width, height] : {std::pair{640, 480}, {320, 240}, {512, 424}, {64, 48}}) {
    const DecodedPreview picture = decoded(preview_png(frame_of(width, height, 6500), 0.0001));
    EXPECT_EQ(picture.header.width, 320U);
    EXPECT_EQ(picture.header.height, 240U);
    EXPECT_EQ(picture.header.bit_depth, 8);
    EXPECT_EQ(picture.header.color_type, SPNG_COLOR_TYPE_GRAYSCALE);
  }
}

TEST(PreviewImage, IsBrighterTheNearerAndBlackWithoutAReading) {
  DepthFrame frame = frame_of(640, 480, 0);
  const std::uint16_t depths_mm10[] = {0, 60000, 15000, 9000, 6500, 5000, 4600, 3000};
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t y = 0; y < 480; ++y) {
      std::fill_n(frame.depth.begin() + static_cast<long>(y * 640 + i * 80), 80, depths_mm10[i]);
    }
  }
  const DecodedPreview picture = decoded(preview_png(frame, 0.0001));
  EXPECT_EQ(picture.at(10, 100), 0);
  EXPECT_GT(picture.at(50, 100), 15);  // far away, but brighter than no reading
  for (int band = 2; band < 7; ++band) {
    EXPECT_GT(picture.at(band * 40 + 20, 100), picture.at(band * 40 - 20, 100)) << band;
  }
  EXPECT_EQ(picture.at(300, 100), 255);
}

TEST(PreviewImage, HasTheRangeOfItsSensor) {
  const DepthFrame near = frame_of(640, 480, 1000);  // 10 cm
  const DepthFrame far = frame_of(640, 480, 2000);
  const SensorTraits& sensor = sensor_traits("Intel RealSense D405");
  EXPECT_LT(decoded(preview_png(far, 0.0001, sensor)).at(50, 100),
            decoded(preview_png(near, 0.0001, sensor)).at(50, 100));
}

TEST(PreviewImage, KeepsThePlaceOfThings) {
  DepthFrame frame = frame_of(640, 480, 15000);
  frame.depth[240 * 640 + 100] = 5000;
  const DecodedPreview picture = decoded(preview_png(frame, 0.0001));
  EXPECT_GT(picture.at(50, 120), picture.at(51, 120));
  EXPECT_GT(picture.at(50, 120), picture.at(50, 121));
}

}  // namespace
}  // namespace octurn
