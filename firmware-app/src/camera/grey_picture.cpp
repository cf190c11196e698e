#include "camera/grey_picture.hpp"

#include <algorithm>
#include <iterator>

#include "octurn/error.hpp"

namespace octurn {
namespace {

/// Where a pixel has its colours, bytes from its first. Luminance is grey: all three are there.
struct PixelBytes {
  std::size_t count = 1;
  std::size_t red = 0;
  std::size_t green = 0;
  std::size_t blue = 0;
};

PixelBytes pixel_bytes(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::yuyv:
      return {.count = 2};
    case PixelLayout::uyvy:
      return {.count = 2, .red = 1, .green = 1, .blue = 1};
    case PixelLayout::rgb_bytes:
      return {.count = 3, .red = 0, .green = 1, .blue = 2};
    case PixelLayout::bgr_bytes:
      return {.count = 3, .red = 2, .green = 1, .blue = 0};
    case PixelLayout::grey:
    case PixelLayout::nv12:
    case PixelLayout::nv21:
    case PixelLayout::yuv420:
    case PixelLayout::yvu420:
    case PixelLayout::yuv422:
    case PixelLayout::yuv444:
      break;
  }
  return {};
}

}  // namespace

Picture grey_picture(std::span<const std::uint8_t> bytes, const PixelRows& rows) {
  const PixelBytes bytes_of = pixel_bytes(rows.layout);
  const std::size_t step = bytes_of.count;
  const auto width = static_cast<std::size_t>(rows.width);
  const auto height = static_cast<std::size_t>(rows.height);
  if (height == 0 || rows.stride < width * step ||
      bytes.size() < (height - 1) * rows.stride + width * step) {
    throw Error(ErrorCode::sensor_failed, "the camera's picture is shorter than its size",
                "Unplug the camera, and plug it in again.");
  }
  Picture picture{.width = rows.width, .height = rows.height};
  picture.samples.reserve(width * height);
  for (std::size_t y = 0; y < height; ++y) {
    const std::uint8_t* const row = &bytes[y * rows.stride];
    if (step == 1) {
      picture.samples.insert(picture.samples.end(), row, row + width);
      continue;
    }
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint8_t* const pixel = row + x * step;
      picture.samples.push_back(
          luminance({pixel[bytes_of.red], pixel[bytes_of.green], pixel[bytes_of.blue]}));
    }
  }
  return picture;
}

}  // namespace octurn
