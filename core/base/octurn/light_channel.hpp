#pragma once

#include "octurn/png.hpp"

namespace octurn {

/// What of a picture's colours shows a laser's light.
enum class Channel { luminance, red, green, blue };

/// A channel of a picture.
Picture to_picture(const ColourPicture& picture, Channel channel);

/// The channel in which a laser's line is seen best: luminance, unless the line is more than twice
/// as bright in another. Luminance has a third of the light of a red laser, and a ninth of that of
/// a blue one.
/// @param lit  of the same size as `dark`
Channel find_channel(const ColourPicture& dark, const ColourPicture& lit);

}  // namespace octurn
