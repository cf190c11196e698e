#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "camera/grey_picture.hpp"
#include "octurn/png.hpp"

namespace octurn {

/// The colours of a camera's picture, with the luminance that `grey_picture` tells of it: a pixel
/// that would be brighter or darker than a picture can be in a channel is paler instead. What is
/// subtracted from pictures with a laser is this luminance.
///
/// Differences of colour are as in ITU-R BT.601, full range. Of a camera that has black at 16 and
/// white at 235, black is at 16 here, too.
///
/// @param planes  as many as the layout has, at least
/// @return width x height, row by row from the top left; nothing if the layout has no colours
/// @throws Error "sensor-failed"  if a plane is missing, or ends before its last row does
std::vector<Rgb> colour_picture(std::span<const std::span<const std::uint8_t>> planes,
                                const PixelRows& rows);

}  // namespace octurn
