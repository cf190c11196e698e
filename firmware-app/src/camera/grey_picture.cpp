#include "camera/grey_picture.hpp"

#include <algorithm>
#include <iterator>

#include "octurn/error.hpp"

namespace octurn {
namespace {

std::size_t bytes_per_pixel(PixelLayout layout) {
  switch (layout) {
    case PixelLayout::grey:
    case PixelLayout::nv12:
    case PixelLayout::nv21:
    case PixelLayout::yuv420:
    case PixelLayout::yvu420:
    case PixelLayout::yuv422:
    case PixelLayout::yuv444:
      return 1;
    case PixelLayout::yuyv:
    case PixelLayout::uyvy:
      return 2;
    case PixelLayout::rgb_bytes:
    case PixelLayout::bgr_bytes:
      break;
  }
  return 3;
}

std::uint8_t luminance_at(const std::uint8_t* pixel, PixelLayout layout) {
  switch (layout) {
    case PixelLayout::grey:
    case PixelLayout::nv12:
    case PixelLayout::nv21:
    case PixelLayout::yuv420:
    case PixelLayout::yvu420:
    case PixelLayout::yuv422:
    case PixelLayout::yuv444:
    case PixelLayout::yuyv:
      return pixel[0];
    case PixelLayout::uyvy:
      return pixel[1];
    case PixelLayout::rgb_bytes:
      return luminance({pixel[0], pixel[1], pixel[2]});
    case PixelLayout::bgr_bytes:
      break;
  }
  return luminance({pixel[2], pixel[1], pixel[0]});
}

}  // namespace

Picture grey_picture(std::span<const std::uint8_t> bytes, const PixelRows& rows) {
  const std::size_t step = bytes_per_pixel(rows.layout);
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
      picture.samples.push_back(luminance_at(row + x * step, rows.layout));
    }
  }
  return picture;
}

}  // namespace octurn
