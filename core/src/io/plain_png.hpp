#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace octurn {

/// A PNG as depth images and pictures are stored, without texts, palette, transparency or
/// interlacing: greyscale of 8 or 16 bits, or RGB of 8.
///
/// libspng reads every PNG, in a third more time: it asks zlib for one row at a time.
struct PlainPng {
  std::uint32_t width = 0;   ///< pixels
  std::uint32_t height = 0;  ///< pixels
  int bit_depth = 0;
  int colour_type = 0;                                 ///< 0 greyscale, 2 RGB
  std::vector<std::span<const std::byte>> parts = {};  ///< of the image data, compressed
};

/// Looks at the chunks of a PNG, and checks their sums. @return nothing if it is not so plain, or
/// damaged
std::optional<PlainPng> find_plain_png(std::span<const std::byte> bytes);

/// Unpacks the pixels, row by row, 16 bits in this machine's byte order. Takes memory for them.
/// @return none if the image data are damaged, or more or less than the header says
std::vector<std::byte> unpack_plain_png(const PlainPng& png);

}  // namespace octurn
