#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "octurn/error.hpp"
#include "octurn/png.hpp"

// Any bytes are refused by an Error, or give a depth image or a camera picture that survives a
// round trip through encoder and decoder.

namespace {

/// CRC-32 as PNG uses it (ISO 3309), bit by bit.
std::uint32_t checksum(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xFFFFFFFFU;
  for (const std::byte byte : bytes) {
    crc ^= std::to_integer<std::uint32_t>(byte);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc >> 1U) ^ ((crc & 1U) * 0xEDB88320U);
    }
  }
  return ~crc;
}

std::uint32_t big_endian(std::span<const std::byte, 4> bytes) {
  std::uint32_t value = 0;
  for (const std::byte byte : bytes) {
    value = value << 8U | std::to_integer<std::uint32_t>(byte);
  }
  return value;
}

/// Corrects each chunk's checksum, which mutations hardly ever hit. A PNG is a signature of 8
/// bytes, then chunks of length, type, `length` bytes and checksum.
void mend_checksums(std::span<std::byte> png) {
  std::size_t start = 8;
  while (start + 12 <= png.size()) {
    const std::span<std::byte> chunk = png.subspan(start);
    const std::size_t length = big_endian(chunk.first<4>());
    if (length > chunk.size() - 12) {
      return;
    }
    std::uint32_t crc = checksum(chunk.subspan(4, 4 + length));
    for (std::size_t i = 4; i-- > 0; crc >>= 8U) {
      chunk[8 + length + i] = static_cast<std::byte>(crc);
    }
    start += 12 + length;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace octurn;
  if (size < 2) {
    return 0;
  }
  const int width = 2 + data[0] % 16;
  const int height = 2 + data[1] % 16;
  const bool mended = data[0] >= 128;
  const std::span<const std::byte> input = std::as_bytes(std::span(data, size)).subspan(2);
  std::vector<std::byte> png(input.begin(), input.end());
  if (mended) {
    mend_checksums(png);
  }
  try {
    const Picture picture = decode_picture_png("input", png, width, height);
    const auto grey = encode_grey_png(width, height, picture.samples);
    if (decode_picture_png("again", grey, width, height).samples != picture.samples) {
      std::abort();
    }
  } catch (const Error&) {
    // not a picture; maybe a depth image
  }
  DepthFrame frame;
  try {
    frame = decode_depth_png("input", png, width, height);
  } catch (const Error&) {
    return 0;
  }
  const DepthFrame again = decode_depth_png("again", encode_depth_png(frame), width, height);
  if (frame.width != width || frame.height != height || again.depth != frame.depth) {
    std::abort();
  }
  return 0;
}
