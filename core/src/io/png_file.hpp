#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/error.hpp"
#include "octurn/png.hpp"

namespace octurn {

/// A text that goes with a picture (a PNG's tEXt chunk).
struct PngText {
  std::string keyword = {};  ///< up to 79 characters; empty: there is no text
  std::string text = {};     ///< ASCII
};

/// A greyscale picture of 16 bits a sample.
struct GreyPng {
  int width = 0;                            ///< pixels
  int height = 0;                           ///< pixels
  std::vector<std::uint16_t> samples = {};  ///< width x height, row by row from the top left
  std::string text = {};                    ///< of the keyword that was asked for; empty if none
};

/// A PNG to decode, and the error for an invalid one.
struct PngSource {
  std::string_view name = {};  ///< of the file, for messages
  std::span<const std::byte> bytes = {};
  ErrorCode malformed = ErrorCode::snapshot_malformed;
  std::string_view hint = {};

  /// Throws the error. @param what  is wrong with the file
  [[noreturn]] void refuse(const std::string& what) const;
};

/// Decodes a 16-bit greyscale PNG.
///
/// @param keyword      of the text to return
/// @param expect_size  called with width and height before pixels are allocated; throws if the size
///                     is not allowed
/// @throws Error "source.malformed"  if it is something else, damaged, cut short, or followed by
///                                   other bytes
GreyPng decode_grey16_png(const PngSource& source, std::string_view keyword,
                          const std::function<void(std::uint32_t, std::uint32_t)>& expect_size);

/// Decodes an 8-bit PNG, greyscale or RGB, to luminance.
/// @param expect_size  as above
/// @throws Error "source.malformed"  as above
std::vector<std::uint8_t> decode_luminance_png(
    const PngSource& source, const std::function<void(std::uint32_t, std::uint32_t)>& expect_size);

/// Decodes an 8-bit PNG, greyscale or RGB, to RGB; greyscale becomes grey.
/// @throws Error "source.malformed"  as above
std::vector<Rgb> decode_rgb_png(
    const PngSource& source, const std::function<void(std::uint32_t, std::uint32_t)>& expect_size);

/// Encodes a greyscale picture of 8 or 16 bits a sample.
/// @throws std::invalid_argument  if it is empty, or there are not width x height samples
std::vector<std::byte> encode_grey_png(int width, int height,
                                       std::span<const std::uint16_t> samples, PngText text);
std::vector<std::byte> encode_grey_png(int width, int height, std::span<const std::uint8_t> samples,
                                       PngText text);

/// Writes an encoded picture, whole or not at all. Makes the file's folder where it is missing.
/// @throws Error "disk-full", "write-failed"
void write_png(const std::filesystem::path& file, std::span<const std::byte> png);

/// "640 x 480 pixels"
std::string size_text(std::uint32_t width, std::uint32_t height);

}  // namespace octurn
