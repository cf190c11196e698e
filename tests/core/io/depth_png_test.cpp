#include <gtest/gtest.h>

#include <random>
#include <stdexcept>
#include <string>

#include "octurn/png.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

/// A PNG of tests/golden, written by another program.
std::string golden(const std::string& name) {
  return content_of(std::filesystem::path(OCTURN_GOLDEN) / name);
}

DepthFrame decode(std::string_view png, int width = 4, int height = 3) {
  return decode_depth_png("000.png", std::as_bytes(std::span(png)), width, height);
}

Error error_of(std::string_view png, int width = 4, int height = 3) {
  return error_thrown_by([&] { decode(png, width, height); });
}

TEST(DepthPng, IsReadAsAnotherProgramWroteIt) {
  const DepthFrame frame = decode(golden("depth_4x3.png"));

  EXPECT_EQ(frame.width, 4);
  EXPECT_EQ(frame.height, 3);
  EXPECT_EQ(frame.depth, (std::vector<std::uint16_t>{0, 8001, 8002, 8003, 8256, 8257, 8258, 8259,
                                                     8512, 8513, 8514, 65535}));
}

TEST(DepthPng, ComesBackAsItWasWritten) {
  DepthFrame frame{.width = 640, .height = 480, .depth = std::vector<std::uint16_t>(640 * 480)};
  std::mt19937 random(3);
  for (std::uint16_t& depth : frame.depth) {
    depth = static_cast<std::uint16_t>(random());
  }
  const std::vector<std::byte> png = encode_depth_png(frame);

  EXPECT_EQ(decode_depth_png("000.png", png, 640, 480).depth, frame.depth);
}

TEST(DepthPng, IsRefusedWhenCutShortAnywhere) {
  const std::string whole = golden("depth_4x3.png");
  ASSERT_FALSE(whole.empty());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(error_of(whole.substr(0, size)).code(), ErrorCode::snapshot_malformed)
        << size << " bytes";
  }
}

TEST(DepthPng, IsRefusedWithBytesAfterItsEnd) {
  EXPECT_EQ(error_of(golden("depth_4x3.png") + '\0').code(), ErrorCode::snapshot_malformed);
}

TEST(DepthPng, IsRefusedWithAnyByteDamaged) {
  const std::string whole = golden("depth_4x3.png");
  ASSERT_FALSE(whole.empty());
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    EXPECT_EQ(error_of(damaged).code(), ErrorCode::snapshot_malformed) << "byte " << i;
  }
}

TEST(DepthPng, IsRefusedWithOtherPixels) {
  for (const char* name : {"grey8_4x3.png", "rgb16_4x3.png"}) {
    const Error error = error_of(golden(name));
    EXPECT_EQ(error.code(), ErrorCode::snapshot_malformed) << name;
    EXPECT_STREQ(error.what(), "000.png: not a 16-bit greyscale PNG") << name;
  }
}

TEST(DepthPng, IsRefusedWithAnotherSize) {
  EXPECT_STREQ(error_of(golden("depth_4x3.png"), 640, 480).what(),
               "000.png: 4 x 3 pixels, where scan.json says 640 x 480 pixels");
  EXPECT_EQ(error_of(golden("depth_4x3.png"), 3, 4).code(), ErrorCode::snapshot_malformed);
}

TEST(DepthPng, IsNotMadeOfAFrameThatIsNotWhole) {
  EXPECT_THROW(encode_depth_png({.width = 2, .height = 2, .depth = {1, 2, 3}}),
               std::invalid_argument);
  EXPECT_THROW(encode_depth_png({}), std::invalid_argument);
}

TEST(PicturePng, IsReadAsAnotherProgramWroteIt) {
  const auto samples = [](const std::string& png) {
    return decode_picture_png("dark.png", std::as_bytes(std::span(png)), 4, 3).samples;
  };
  const std::vector<std::uint8_t> grey = {0, 10, 20, 30, 40, 50, 100, 150, 200, 250, 254, 255};
  // The luminance of red, green, blue and white, then of greys, which keep their level.
  const std::vector<std::uint8_t> of_colours = {76,  150, 29,  255, 40,  50,
                                                100, 150, 200, 250, 254, 255};
  EXPECT_EQ(samples(golden("picture_grey8_4x3.png")), grey);
  EXPECT_EQ(samples(golden("picture_rgb8_4x3.png")), of_colours);
}

TEST(PicturePng, IsRefusedIfItIsAnotherKindOrSizeOrDamaged) {
  const auto refusal = [](const std::string& png, int width) {
    return error_thrown_by(
        [&] { decode_picture_png("dark.png", std::as_bytes(std::span(png)), width, 3); });
  };
  const std::string whole = golden("picture_rgb8_4x3.png");
  EXPECT_EQ(refusal(golden("depth_4x3.png"), 4).code(), ErrorCode::snapshot_malformed);
  EXPECT_NE(std::string(refusal(whole, 5).what()).find("4 x 3"), std::string::npos);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_EQ(refusal(whole.substr(0, size), 4).code(), ErrorCode::snapshot_malformed)
        << size << " bytes";
  }
  EXPECT_EQ(refusal(whole + "x", 4).code(), ErrorCode::snapshot_malformed);
}

}  // namespace
}  // namespace octurn
