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

/// Encodes a depth image as 16-bit greyscale PNG.
///
/// @throws std::invalid_argument  if the frame is empty, or its depth is not width x height
std::vector<std::byte> encode_depth_png(const DepthFrame& frame);

/// Encodes a picture for people as 8-bit greyscale PNG.
///
/// @param samples  width x height, row by row from the top left; 0 is black
/// @throws std::invalid_argument  if it is empty, or there are not width x height samples
std::vector<std::byte> encode_grey_png(int width, int height,
                                       std::span<const std::uint8_t> samples);

/// Red, green, blue and opacity.
using Rgba = std::array<std::uint8_t, 4>;

/// Encodes a picture for people as 8-bit PNG with colour and opacity.
///
/// @param pixels  width x height, row by row from the top left
/// @throws std::invalid_argument  if it is empty, or there are not width x height pixels
std::vector<std::byte> encode_colour_png(int width, int height, std::span<const Rgba> pixels);

/// Decodes a 16-bit greyscale PNG of exactly that size in pixels.
///
/// @param name  of the file, for messages
/// @throws Error "snapshot-malformed"  if it is something else, has another size, is damaged, cut
///                                     short, or followed by other bytes
DepthFrame decode_depth_png(std::string_view name, std::span<const std::byte> png, int width,
                            int height);

/// A camera's picture.
struct Picture {
  int width = 0;                           ///< pixels
  int height = 0;                          ///< pixels
  std::vector<std::uint8_t> samples = {};  ///< luminance, width x height, row by row from the top
};

/// Decodes an 8-bit PNG of exactly that size in pixels: greyscale, or RGB, of which the luminance
/// is taken (ITU-R BT.601).
///
/// @param name  of the file, for messages
/// @throws Error "snapshot-malformed"  as `decode_depth_png`
Picture decode_picture_png(std::string_view name, std::span<const std::byte> png, int width,
                           int height);

/// Writes a depth image as 16-bit greyscale PNG, whole or not at all, and returns when it is on the
/// disk. Makes the file's folder where it is missing.
///
/// @throws Error "disk-full", "write-failed"
/// @throws std::invalid_argument  as `encode_depth_png`
void write_depth_png(const std::filesystem::path& file, const DepthFrame& frame);

}  // namespace octurn
