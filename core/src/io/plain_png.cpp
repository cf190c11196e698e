#include "io/plain_png.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

namespace octurn {
namespace {

using Bytes = std::span<const std::byte>;

constexpr std::array<unsigned char, 8> signature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::uint32_t max_side = 1U << 16U;  // pixels: more is libspng's to refuse
constexpr std::size_t header_bytes = 13;
constexpr std::size_t length_bytes = 4;
constexpr std::size_t type_bytes = 4;
constexpr std::size_t sum_bytes = 4;

/// Chunks that tell how pixels should look, and nothing of what they are.
constexpr std::array<std::string_view, 4> of_looks{"gAMA", "cHRM", "sRGB", "pHYs"};

std::uint32_t big_endian(Bytes bytes) {
  std::uint32_t value = 0;
  for (const std::byte byte : bytes.first(4)) {
    value = value << 8 | std::to_integer<std::uint32_t>(byte);
  }
  return value;
}

struct Chunk {
  std::string_view type = {};
  Bytes content = {};
};

/// Takes a chunk from the front, if it is whole and its sum is right.
std::optional<Chunk> take_chunk(Bytes& bytes) {
  constexpr std::size_t around = length_bytes + type_bytes + sum_bytes;
  if (bytes.size() < around) {
    return std::nullopt;
  }
  const std::size_t length = big_endian(bytes);
  if (length > bytes.size() - around) {
    return std::nullopt;
  }
  const Bytes summed = bytes.subspan(length_bytes, type_bytes + length);
  const auto* const data = reinterpret_cast<const Bytef*>(summed.data());
  if (crc32_z(0, data, summed.size()) != big_endian(bytes.subspan(length_bytes + summed.size()))) {
    return std::nullopt;
  }
  bytes = bytes.subspan(around + length);
  return Chunk{.type = {reinterpret_cast<const char*>(summed.data()), type_bytes},
               .content = summed.subspan(type_bytes)};
}

/// Reads the header's content, and whether it is a plain one.
bool read_header(Bytes content, PlainPng& png) {
  if (content.size() != header_bytes) {
    return false;
  }
  const auto at = [&](std::size_t i) { return std::to_integer<int>(content[i]); };
  png.width = big_endian(content);
  png.height = big_endian(content.subspan(4));
  png.bit_depth = at(8);
  png.colour_type = at(9);
  const bool is_grey = png.colour_type == 0 && (png.bit_depth == 8 || png.bit_depth == 16);
  const bool is_rgb = png.colour_type == 2 && png.bit_depth == 8;
  const bool is_usual = at(10) == 0 && at(11) == 0 && at(12) == 0;  // not interlaced
  const auto is_side = [](std::uint32_t side) { return side > 0 && side <= max_side; };
  return is_side(png.width) && is_side(png.height) && (is_grey || is_rgb) && is_usual;
}

/// zlib's state, freed again.
struct Inflater {
  z_stream stream = {};
  bool is_up = inflateInit(&stream) == Z_OK;

  Inflater() = default;
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() {
    if (is_up) {
      inflateEnd(&stream);
    }
  }
};

/// Whether the parts are one whole stream, which fills `to` exactly.
bool inflate_all(const std::vector<Bytes>& parts, std::vector<std::byte>& to) {
  Inflater inflater;
  z_stream& stream = inflater.stream;
  stream.next_out = reinterpret_cast<Bytef*>(to.data());
  stream.avail_out = static_cast<uInt>(to.size());
  int status = inflater.is_up ? Z_OK : Z_MEM_ERROR;
  for (const Bytes part : parts) {
    // zlib changes nothing there, but says so only where it is compiled to.
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(part.data()));
    stream.avail_in = static_cast<uInt>(part.size());
    if (status == Z_OK && stream.avail_in > 0) {
      status = inflate(&stream, Z_NO_FLUSH);
    }
    if (stream.avail_in > 0) {
      return false;
    }
  }
  return status == Z_STREAM_END && stream.avail_out == 0;
}

/// Of left, above and above left, the one that is nearest to left + above - above left; the first
/// of those that are equally near.
int paeth(int left, int above, int above_left) {
  const int to_left = std::abs(above - above_left);
  const int to_above = std::abs(left - above_left);
  const int to_above_left = std::abs(left + above - 2 * above_left);
  const int other = to_above <= to_above_left ? above : above_left;
  return to_left <= to_above && to_left <= to_above_left ? left : other;
}

/// Undoes the filter of a row (Portable Network Graphics, second edition, section 9).
/// @tparam pixel  bytes from a byte to that of the pixel on its left
/// @param above   the row above, undone already
/// @return whether there is such a filter
template <std::size_t pixel>
bool undo_filter(int filter, std::span<std::uint8_t> row, std::span<const std::uint8_t> above) {
  const auto add = [&](std::size_t i, int predicted) {
    row[i] = static_cast<std::uint8_t>(row[i] + predicted);
  };
  switch (filter) {
    case 0:
      return true;
    case 1:
      for (std::size_t i = pixel; i < row.size(); ++i) {
        add(i, row[i - pixel]);
      }
      return true;
    case 2:
      for (std::size_t i = 0; i < row.size(); ++i) {
        add(i, above[i]);
      }
      return true;
    case 3:
      for (std::size_t i = 0; i < row.size(); ++i) {
        add(i, ((i < pixel ? 0 : row[i - pixel]) + above[i]) / 2);
      }
      return true;
    case 4:
      for (std::size_t i = 0; i < std::min(pixel, row.size()); ++i) {
        add(i, above[i]);
      }
      for (std::size_t i = pixel; i < row.size(); ++i) {
        add(i, paeth(row[i - pixel], above[i], above[i - pixel]));
      }
      return true;
    default:
      return false;
  }
}

/// Undoes the filters of all rows, and takes out the bytes that tell them.
template <std::size_t pixel>
bool undo_filters(std::vector<std::byte>& pixels, std::size_t row_bytes) {
  const std::vector<std::uint8_t> nothing(row_bytes);
  std::span<const std::uint8_t> above = nothing;
  auto* const bytes = reinterpret_cast<std::uint8_t*>(pixels.data());
  const std::size_t rows = pixels.size() / (row_bytes + 1);
  for (std::size_t i = 0; i < rows; ++i) {
    std::uint8_t* const filter = bytes + i * (row_bytes + 1);
    const std::span<std::uint8_t> row(filter + 1, row_bytes);
    if (!undo_filter<pixel>(*filter, row, above)) {
      return false;
    }
    above = row;
  }
  for (std::size_t i = 0; i < rows; ++i) {
    std::memmove(bytes + i * row_bytes, bytes + i * (row_bytes + 1) + 1, row_bytes);
  }
  pixels.resize(rows * row_bytes);
  return true;
}

void swap_bytes(std::vector<std::byte>& samples) {
  for (std::size_t i = 0; i + 1 < samples.size(); i += sizeof(std::uint16_t)) {
    std::uint16_t sample = 0;
    std::memcpy(&sample, &samples[i], sizeof sample);
    sample = static_cast<std::uint16_t>(sample << 8U | sample >> 8U);
    std::memcpy(&samples[i], &sample, sizeof sample);
  }
}

}  // namespace

std::optional<PlainPng> find_plain_png(Bytes bytes) {
  if (bytes.size() < signature.size() ||
      std::memcmp(bytes.data(), signature.data(), signature.size()) != 0) {
    return std::nullopt;
  }
  bytes = bytes.subspan(signature.size());
  PlainPng png;
  const auto header = take_chunk(bytes);
  if (!header || header->type != "IHDR" || !read_header(header->content, png)) {
    return std::nullopt;
  }
  for (auto chunk = take_chunk(bytes); chunk; chunk = take_chunk(bytes)) {
    if (chunk->type == "IDAT") {
      png.parts.push_back(chunk->content);
    } else if (chunk->type == "IEND" && chunk->content.empty() && bytes.empty()) {
      return png;
    } else if (!png.parts.empty() || std::ranges::find(of_looks, chunk->type) == of_looks.end()) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

std::vector<std::byte> unpack_plain_png(const PlainPng& png) {
  const std::size_t pixel =
      static_cast<std::size_t>(png.bit_depth) / 8 * (png.colour_type == 2 ? 3 : 1);
  const std::size_t row_bytes = png.width * pixel;
  std::vector<std::byte> pixels(png.height * (row_bytes + 1));
  if (pixels.size() > std::numeric_limits<uInt>::max() || !inflate_all(png.parts, pixels)) {
    return {};
  }
  const bool is_undone = pixel == 1   ? undo_filters<1>(pixels, row_bytes)
                         : pixel == 2 ? undo_filters<2>(pixels, row_bytes)
                                      : undo_filters<3>(pixels, row_bytes);
  if (!is_undone) {
    return {};
  }
  if (pixel == 2 && std::endian::native == std::endian::little) {
    swap_bytes(pixels);
  }
  return pixels;
}

}  // namespace octurn
