#include "camera/colour_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using Planes = std::span<const std::span<const std::uint8_t>>;

/// Where a format has the samples of a channel.
struct Channel {
  std::size_t plane = 0;
  std::size_t first = 0;        ///< bytes before the first sample of a row
  std::size_t step = 1;         ///< bytes from a sample to the next
  unsigned halvings_x = 0;      ///< how often the picture's width is halved for it
  unsigned halvings_y = 0;      ///< the same of its height
  std::size_t part_of_row = 1;  ///< its rows have this part of the first plane's bytes
};
using Channels = std::array<Channel, 3>;

/// Luminance, blue less luminance, red less luminance; or red, green, blue.
Channels channels_of(PixelLayout layout) {
  const Channel luminance{};
  const auto interleaved = [](std::size_t first) {
    return Channel{.plane = 1, .first = first, .step = 2, .halvings_x = 1, .halvings_y = 1};
  };
  const auto alone = [](std::size_t plane) {
    return Channel{.plane = plane, .halvings_x = 1, .halvings_y = 1, .part_of_row = 2};
  };
  const auto packed = [](std::size_t first) {
    return Channel{.first = first, .step = 4, .halvings_x = 1};
  };
  const auto bytes = [](std::size_t first) { return Channel{.first = first, .step = 3}; };
  switch (layout) {
    case PixelLayout::yuyv:
      return {Channel{.step = 2}, packed(1), packed(3)};
    case PixelLayout::uyvy:
      return {Channel{.first = 1, .step = 2}, packed(0), packed(2)};
    case PixelLayout::nv12:
      return {luminance, interleaved(0), interleaved(1)};
    case PixelLayout::nv21:
      return {luminance, interleaved(1), interleaved(0)};
    case PixelLayout::yuv420:
      return {luminance, alone(1), alone(2)};
    case PixelLayout::yvu420:
      return {luminance, alone(2), alone(1)};
    case PixelLayout::yuv422:
      return {luminance, Channel{.plane = 1, .halvings_x = 1, .part_of_row = 2},
              Channel{.plane = 2, .halvings_x = 1, .part_of_row = 2}};
    case PixelLayout::yuv444:
      return {luminance, Channel{.plane = 1}, Channel{.plane = 2}};
    case PixelLayout::rgb_bytes:
      return {bytes(0), bytes(1), bytes(2)};
    case PixelLayout::bgr_bytes:
      return {bytes(2), bytes(1), bytes(0)};
    case PixelLayout::grey:
      break;
  }
  return {};
}

/// The samples of a channel, each for the pixels that share it.
class Samples {
 public:
  /// @throws Error "sensor-failed"
  Samples(Planes planes, const PixelRows& rows, const Channel& channel)
      : channel_(channel), stride_(rows.stride / channel.part_of_row) {
    const std::size_t last_x = static_cast<std::size_t>(rows.width - 1) >> channel.halvings_x;
    const std::size_t last_y = static_cast<std::size_t>(rows.height - 1) >> channel.halvings_y;
    const std::size_t row_bytes = channel.first + last_x * channel.step + 1;
    if (channel.plane >= planes.size() || stride_ < row_bytes ||
        planes[channel.plane].size() < last_y * stride_ + row_bytes) {
      throw Error(ErrorCode::sensor_failed, "the camera's picture is shorter than its size",
                  "Unplug the camera, and plug it in again.");
    }
    bytes_ = planes[channel.plane];
  }

  std::uint8_t at(std::size_t x, std::size_t y) const {
    return bytes_[(y >> channel_.halvings_y) * stride_ + channel_.first +
                  (x >> channel_.halvings_x) * channel_.step];
  }

 private:
  Channel channel_;
  std::size_t stride_;
  std::span<const std::uint8_t> bytes_ = {};
};

/// @param blue, red  less luminance, 128 where there is no colour
Rgb to_rgb(std::uint8_t luminance, std::uint8_t blue, std::uint8_t red) {
  const auto y = static_cast<float>(luminance);
  const float u = static_cast<float>(blue) - 128;
  const float v = static_cast<float>(red) - 128;
  // ITU-R BT.601: what it has 0.299 R + 0.587 G + 0.114 B = Y follow from.
  const std::array<float, 3> more{1.402F * v, -0.344136F * u - 0.714136F * v, 1.772F * u};
  float share = 1;
  for (const float channel : more) {
    if (y + channel > 255) {
      share = std::min(share, (255 - y) / channel);
    } else if (y + channel < 0) {
      share = std::min(share, -y / channel);
    }
  }
  Rgb rgb{};
  std::ranges::transform(more, rgb.begin(), [&](float channel) {
    return static_cast<std::uint8_t>(y + share * channel + 0.5F);
  });
  return rgb;
}

}  // namespace

std::vector<Rgb> colour_picture(Planes planes, const PixelRows& rows) {
  if (rows.layout == PixelLayout::grey) {
    return {};
  }
  const bool is_rgb =
      rows.layout == PixelLayout::rgb_bytes || rows.layout == PixelLayout::bgr_bytes;
  const Channels channels = channels_of(rows.layout);
  const Samples a(planes, rows, channels[0]);
  const Samples b(planes, rows, channels[1]);
  const Samples c(planes, rows, channels[2]);
  const auto width = static_cast<std::size_t>(rows.width);
  const auto height = static_cast<std::size_t>(rows.height);
  std::vector<Rgb> pixels;
  pixels.reserve(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      pixels.push_back(is_rgb ? Rgb{a.at(x, y), b.at(x, y), c.at(x, y)}
                              : to_rgb(a.at(x, y), b.at(x, y), c.at(x, y)));
    }
  }
  return pixels;
}

}  // namespace octurn
