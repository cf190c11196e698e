#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// A camera's picture in shades of grey.
struct Picture {
  int width = 0;                           ///< pixels
  int height = 0;                          ///< pixels
  std::vector<std::uint8_t> samples = {};  ///< luminance, width x height, row by row from the top
};

/// Red, green and blue, as a camera's picture has them (sRGB).
using Rgb = std::array<std::uint8_t, 3>;

/// The luminance of a colour, rounded (ITU-R BT.601).
constexpr std::uint8_t luminance(const Rgb& colour) {
  return static_cast<std::uint8_t>((299 * colour[0] + 587 * colour[1] + 114 * colour[2] + 500) /
                                   1000);
}

/// A camera's picture in colour.
struct ColourPicture {
  int width = 0;                 ///< pixels
  int height = 0;                ///< pixels
  std::vector<Rgb> pixels = {};  ///< width x height, row by row from the top left
};

/// Red, green, blue and opacity.
using Rgba = std::array<std::uint8_t, 4>;

/// Encodes a depth image as 16-bit greyscale PNG.
/// @throws std::invalid_argument  if the frame is empty, or its depth is not width x height
std::vector<std::byte> encode_depth_png(const DepthFrame& frame);

/// Encodes luminance as 8-bit greyscale PNG.
/// @param samples  width x height, row by row from the top left; 0 is black
/// @throws std::invalid_argument  if it is empty, or there are not width x height samples
std::vector<std::byte> encode_grey_png(int width, int height,
                                       std::span<const std::uint8_t> samples);

/// Encodes a picture as 8-bit RGB PNG, fast rather than small.
/// @throws std::invalid_argument  if it is empty, or there are not width x height pixels
std::vector<std::byte> encode_rgb_png(const ColourPicture& picture);

/// Encodes an image with transparent parts as 8-bit RGBA PNG.
/// @param pixels  width x height, row by row from the top left
/// @throws std::invalid_argument  if it is empty, or there are not width x height pixels
std::vector<std::byte> encode_colour_png(int width, int height, std::span<const Rgba> pixels);

/// Decodes a 16-bit greyscale PNG that must be width x height pixels.
/// @param name  of the file, for messages
/// @throws Error "snapshot-malformed"  if it has another format or size, is damaged, cut short, or
///                                     followed by other bytes
DepthFrame decode_depth_png(std::string_view name, std::span<const std::byte> png, int width,
                            int height);

/// Decodes an 8-bit PNG that must be width x height pixels: greyscale, or RGB, which becomes
/// luminance (ITU-R BT.601).
/// @throws Error "snapshot-malformed"  as `decode_depth_png`
Picture decode_picture_png(std::string_view name, std::span<const std::byte> png, int width,
                           int height);

/// Decodes the same files as `decode_picture_png` to colours; greyscale becomes grey.
/// @throws Error "snapshot-malformed"  as `decode_depth_png`
ColourPicture decode_rgb_png(std::string_view name, std::span<const std::byte> png, int width,
                             int height);

/// Writes a depth image as 16-bit greyscale PNG, whole or not at all, and returns when it is on the
/// disk. Makes the file's folder where it is missing.
/// @throws Error "disk-full", "write-failed"
/// @throws std::invalid_argument  as `encode_depth_png`
void write_depth_png(const std::filesystem::path& file, const DepthFrame& frame);

}  // namespace octurn
