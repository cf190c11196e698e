#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "camera/grey_picture.hpp"
#include "octurn/png.hpp"

namespace octurn {

/// A picture that came as a JPEG, in planes: luminance, and of one with colours the differences of
/// blue and of red from it.
struct JpegPlanes {
  PixelRows rows = {};
  std::array<std::vector<std::uint8_t>, 3> planes = {};
};

// What is not whole, or no JPEG of the size, is a damaged picture: USB loses parts of pictures. A
// few bytes too many before a marker are none: many cameras leave them in each of their pictures.
// Cameras may leave out the Huffman tables, and pad the end.

/// The luminance of a JPEG, as it is in there.
/// @return nothing if the picture is damaged
std::optional<Picture> grey_jpeg(std::span<const std::uint8_t> bytes, int width, int height);

/// The planes of a JPEG, for `colour_picture`. Of one whose colours are at other pixels than a
/// `PixelLayout` has, luminance alone.
/// @return nothing if the picture is damaged
std::optional<JpegPlanes> jpeg_planes(std::span<const std::uint8_t> bytes, int width, int height);

}  // namespace octurn
