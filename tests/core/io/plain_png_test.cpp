#include "io/plain_png.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace octurn {
namespace {

using Bytes = std::basic_string<unsigned char>;

void append_big_endian(Bytes& to, std::size_t value) {
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    to += static_cast<unsigned char>(value >> shift);
  }
}

void append_chunk(Bytes& png, std::string_view type, const Bytes& content) {
  append_big_endian(png, content.size());
  const Bytes summed = Bytes(type.begin(), type.end()) + content;
  png += summed;
  append_big_endian(png, crc32_z(0, summed.data(), summed.size()));
}

/// What a filter predicts of a byte (Portable Network Graphics, second edition, table 9.1).
int predict(std::size_t filter, int left, int above, int above_left) {
  const int linear = left + above - above_left;
  const auto distance = [&](int of) { return std::abs(linear - of); };
  switch (filter) {
    case 1:
      return left;
    case 2:
      return above;
    case 3:
      return (left + above) / 2;
    case 4:
      return distance(left) <= distance(above) && distance(left) <= distance(above_left) ? left
             : distance(above) <= distance(above_left)                                   ? above
                                                       : above_left;
    default:
      return 0;
  }
}

/// How a PNG is made.
struct Kind {
  std::size_t width = 23;
  std::size_t height = 35;
  unsigned char bit_depth = 16;
  unsigned char colour_type = 0;
  std::size_t pixel = 2;  // bytes
  std::size_t parts = 3;  // of the image data
  unsigned char interlaced = 0;
  std::size_t lost = 0;  // bytes of the image data
};

/// Bytes that rise slowly, with noise: all filters mean something.
Bytes samples_of(const Kind& kind) {
  std::mt19937 random(7);
  Bytes samples;
  for (std::size_t i = 0; i < kind.width * kind.height * kind.pixel; ++i) {
    samples += static_cast<unsigned char>(i / 5 + random() % 9);
  }
  return samples;
}

/// A PNG whose rows have each filter in turn.
Bytes png_of(const Kind& kind, const Bytes& samples, std::string_view also = "gAMA") {
  const std::size_t row_bytes = kind.width * kind.pixel;
  const auto at = [&](std::size_t row, std::size_t i, bool is_left, bool is_above) {
    const bool is_there = (!is_left || i >= kind.pixel) && (!is_above || row > 0);
    return is_there ? int{samples[(row - (is_above ? 1 : 0)) * row_bytes + i -
                                  (is_left ? kind.pixel : 0)]}
                    : 0;
  };
  Bytes filtered;
  for (std::size_t row = 0; row < kind.height; ++row) {
    const std::size_t filter = row % 5;
    filtered += static_cast<unsigned char>(filter);
    for (std::size_t i = 0; i < row_bytes; ++i) {
      filtered += static_cast<unsigned char>(
          at(row, i, false, false) - predict(filter, at(row, i, true, false),
                                             at(row, i, false, true), at(row, i, true, true)));
    }
  }
  filtered.resize(filtered.size() - kind.lost);
  uLongf size = compressBound(filtered.size());
  Bytes packed(size, 0);
  EXPECT_EQ(compress(packed.data(), &size, filtered.data(), filtered.size()), Z_OK);
  packed.resize(size);

  Bytes png{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  Bytes header;
  append_big_endian(header, kind.width);
  append_big_endian(header, kind.height);
  header += {kind.bit_depth, kind.colour_type, 0, 0, kind.interlaced};
  append_chunk(png, "IHDR", header);
  append_chunk(png, also, {0, 1, 2, 3});
  for (std::size_t part = 0; part < kind.parts; ++part) {
    const std::size_t first = size * part / kind.parts;
    append_chunk(png, "IDAT", packed.substr(first, size * (part + 1) / kind.parts - first));
  }
  append_chunk(png, "IEND", {});
  return png;
}

std::optional<PlainPng> find(const Bytes& png) {
  return find_plain_png(std::as_bytes(std::span(png)));
}

/// The pixels as a PNG stores them: 16 bits in big endian.
std::optional<Bytes> unpacked(const Bytes& png) {
  const auto plain = find(png);
  const auto pixels = plain ? unpack_plain_png(*plain) : std::vector<std::byte>();
  if (pixels.empty()) {
    return std::nullopt;
  }
  Bytes bytes;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const bool is_swapped = plain->bit_depth == 16 && std::endian::native == std::endian::little;
    bytes += std::to_integer<unsigned char>(pixels[is_swapped ? i ^ 1U : i]);
  }
  return bytes;
}

TEST(PlainPng, IsUnpackedWhateverTheFiltersOfItsRows) {
  for (const Kind& kind : {Kind{}, Kind{.bit_depth = 8, .pixel = 1}, Kind{.width = 1},
                           Kind{.bit_depth = 8, .colour_type = 2, .pixel = 3, .parts = 1}}) {
    const Bytes samples = samples_of(kind);
    const auto found = unpacked(png_of(kind, samples));
    ASSERT_TRUE(found);
    EXPECT_EQ(*found, samples) << kind.pixel << " bytes a pixel";
  }
}

TEST(PlainPng, IsNoneWithAnyByteDamagedOrLost) {
  const Kind kind{.width = 5, .height = 6};
  const Bytes whole = png_of(kind, samples_of(kind));
  ASSERT_TRUE(unpacked(whole));
  for (std::size_t i = 0; i < whole.size(); ++i) {
    Bytes damaged = whole;
    damaged[i] = static_cast<unsigned char>(damaged[i] ^ 0x10U);
    EXPECT_FALSE(unpacked(damaged)) << "byte " << i;
    EXPECT_FALSE(unpacked(whole.substr(0, i))) << i << " bytes";
  }
  EXPECT_FALSE(unpacked(whole + Bytes{0}));
}

TEST(PlainPng, IsNoneWithLessThanItsHeaderSays) {
  const Kind kind{.lost = 1};
  const Bytes png = png_of(kind, samples_of(kind));
  ASSERT_TRUE(find(png));
  EXPECT_FALSE(unpacked(png));
}

TEST(PlainPng, IsNoneIfLibspngHasMoreToRead) {
  const Bytes samples = samples_of({});
  EXPECT_FALSE(find(png_of({}, samples, "tEXt")));
  EXPECT_FALSE(find(png_of({}, samples, "PLTE")));
  EXPECT_FALSE(find(png_of({.interlaced = 1}, samples)));
  EXPECT_FALSE(find(png_of({.bit_depth = 16, .colour_type = 2, .pixel = 2}, samples)));
}

}  // namespace
}  // namespace octurn
