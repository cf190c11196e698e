#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "octurn/png.hpp"

namespace octurn {

/// How what a camera wrote is arranged. U and V are the differences of blue and red from luminance.
enum class PixelLayout {
  grey,       ///< one byte a pixel
  nv12,       ///< a plane of luminance as grey; one of U and V by turns, for 2 x 2 pixels
  nv21,       ///< the same with V and U
  yuv420,     ///< a plane of luminance; one of U and one of V, each for 2 x 2 pixels
  yvu420,     ///< the same with V before U
  yuv422,     ///< a plane of luminance; one of U and one of V, each for 2 pixels of a row
  yuv444,     ///< three planes, each for every pixel
  yuyv,       ///< two bytes a pixel, the first is luminance, the others U and V of two pixels
  uyvy,       ///< two, the second is luminance
  rgb_bytes,  ///< three: red, green, blue in memory
  bgr_bytes,  ///< three: blue, green, red in memory
};

/// Rows of pixels in memory: of formats in planes, those of the first.
struct PixelRows {
  PixelLayout layout = PixelLayout::grey;
  int width = 0;           ///< pixels
  int height = 0;          ///< pixels
  std::size_t stride = 0;  ///< bytes from the beginning of a row to that of the next
};

/// The luminance of a camera's picture: that of the camera, or of its colours by ITU-R BT.601.
/// @param bytes  of its first plane
/// @throws Error "sensor-failed"  if the bytes end before the last row does
Picture grey_picture(std::span<const std::uint8_t> bytes, const PixelRows& rows);

}  // namespace octurn
