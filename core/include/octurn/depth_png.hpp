#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "octurn/depth_frame.hpp"

namespace octurn {

/// A depth image as 16-bit greyscale PNG.
///
/// @throws std::invalid_argument  if the frame is empty, or its depth is not width x height
std::vector<std::byte> encode_depth_png(const DepthFrame& frame);

/// A picture for people as 8-bit greyscale PNG, row by row from the top.
///
/// @throws std::invalid_argument  if it is empty, or there are not width x height samples
std::vector<std::byte> encode_grey_png(int width, int height,
                                       std::span<const std::uint8_t> samples);

/// Reads a 16-bit greyscale PNG of exactly that size in pixels.
///
/// @param name  of the file, for messages
/// @throws Error "snapshot-malformed"  if it is something else, has another size, is damaged, cut
///                                     short, or followed by other bytes
DepthFrame decode_depth_png(std::string_view name, std::span<const std::byte> png, int width,
                            int height);

}  // namespace octurn
