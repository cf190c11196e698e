#pragma once

#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {

/// A JPEG of a picture's luminance with constant chrominance Cb (`blue`) and Cr (`red`).
/// @param subsampling  TJSAMP_444, TJSAMP_422, ...; TJSAMP_GRAY has no chrominance
inline std::vector<std::uint8_t> jpeg_of(const Picture& picture, int subsampling,
                                         std::uint8_t blue = 128, std::uint8_t red = 128) {
  const int stride = picture.width + 16;
  const auto size = static_cast<std::size_t>(stride * (picture.height + 16));
  std::array<std::vector<std::uint8_t>, 3> planes{std::vector<std::uint8_t>(size),
                                                  std::vector<std::uint8_t>(size, blue),
                                                  std::vector<std::uint8_t>(size, red)};
  for (int y = 0; y < picture.height + 16; ++y) {
    for (int x = 0; x < stride; ++x) {  // pads by repeating the last row and column
      planes[0][static_cast<std::size_t>(y * stride + x)] =
          picture.samples[static_cast<std::size_t>(std::min(y, picture.height - 1) * picture.width +
                                                   std::min(x, picture.width - 1))];
    }
  }
  std::array<const unsigned char*, 3> begins{planes[0].data(), planes[1].data(), planes[2].data()};
  const std::array<int, 3> strides{stride, stride, stride};
  tjhandle compressor = ::tjInitCompress();
  unsigned char* bytes = nullptr;
  unsigned long count = 0;
  const int result =
      ::tjCompressFromYUVPlanes(compressor, begins.data(), picture.width, strides.data(),
                                picture.height, subsampling, &bytes, &count, 100, 0);
  std::vector<std::uint8_t> jpeg;
  if (result == 0) {
    jpeg.assign(bytes, bytes + count);
  }
  ::tjFree(bytes);
  ::tjDestroy(compressor);
  if (result != 0) {
    throw std::runtime_error("no JPEG was made");
  }
  return jpeg;
}

/// Removes a JPEG's Huffman tables.
inline std::vector<std::uint8_t> without_tables(std::vector<std::uint8_t> jpeg) {
  constexpr std::uint8_t huffman_tables = 0xc4;
  constexpr std::uint8_t start_of_scan = 0xda;
  std::size_t at = 2;
  while (jpeg[at + 1] != start_of_scan) {
    const std::size_t length = 2U + jpeg[at + 2] * 256U + jpeg[at + 3];
    if (jpeg[at + 1] == huffman_tables) {
      const auto begin = jpeg.begin() + static_cast<std::ptrdiff_t>(at);
      jpeg.erase(begin, begin + static_cast<std::ptrdiff_t>(length));
    } else {
      at += length;
    }
  }
  return jpeg;
}

}  // namespace octurn
