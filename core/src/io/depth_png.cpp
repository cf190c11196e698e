#include "octurn/depth_png.hpp"

#include <spng.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

constexpr std::size_t max_chunk_bytes = 1U << 20U;  // of texts and the like, which are not used

struct FreeContext {
  void operator()(spng_ctx* context) const { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, FreeContext>;

[[noreturn]] void malformed(std::string_view name, const std::string& what) {
  throw Error(ErrorCode::snapshot_malformed, std::string(name) + ": " + what,
              "The file is damaged, or not written by a scan.");
}

void check_encoded(int status) {
  if (status != 0) {
    throw std::runtime_error(std::string("encode_png: ") + spng_strerror(status));
  }
}

/// Bytes that libspng takes from the front.
struct Source {
  std::span<const std::byte> bytes;
  bool ran_out = false;  // libspng itself passes over a missing checksum at the very end
};

int take(spng_ctx* /*context*/, void* source, void* destination, std::size_t size) noexcept {
  auto& [bytes, ran_out] = *static_cast<Source*>(source);
  if (size > bytes.size()) {
    ran_out = true;
    return SPNG_IO_EOF;
  }
  std::memcpy(destination, bytes.data(), size);
  bytes = bytes.subspan(size);
  return 0;
}

std::string dimensions(std::uint32_t width, std::uint32_t height) {
  return std::to_string(width) + " x " + std::to_string(height) + " pixels";
}

/// Encodes a greyscale image of 8 or 16 bits a sample.
template <typename Sample>
std::vector<std::byte> encode(int width, int height, std::span<const Sample> samples) {
  if (width < 1 || height < 1 ||
      samples.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height)) {
    throw std::invalid_argument("encode_png: there are not width x height samples");
  }
  const Context context(spng_ctx_new(SPNG_CTX_ENCODER));
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(width);
  header.height = static_cast<std::uint32_t>(height);
  header.bit_depth = 8 * sizeof(Sample);
  header.color_type = SPNG_COLOR_TYPE_GRAYSCALE;
  check_encoded(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
  check_encoded(spng_set_ihdr(context.get(), &header));
  check_encoded(spng_encode_image(context.get(), samples.data(), samples.size_bytes(), SPNG_FMT_PNG,
                                  SPNG_ENCODE_FINALIZE));
  std::size_t size = 0;
  int status = 0;
  const std::unique_ptr<void, decltype(&std::free)> png(
      spng_get_png_buffer(context.get(), &size, &status), &std::free);
  check_encoded(status);
  const auto* bytes = static_cast<const std::byte*>(png.get());
  return {bytes, bytes + size};
}

}  // namespace

std::vector<std::byte> encode_depth_png(const DepthFrame& frame) {
  return encode(frame.width, frame.height, std::span(frame.depth));
}

std::vector<std::byte> encode_grey_png(int width, int height,
                                       std::span<const std::uint8_t> samples) {
  return encode(width, height, samples);
}

DepthFrame decode_depth_png(std::string_view name, std::span<const std::byte> png, int width,
                            int height) {
  const auto check = [&](int status) {
    if (status != 0) {
      malformed(name, std::string("not a whole PNG: ") + spng_strerror(status));
    }
  };
  Source source{.bytes = png};
  const Context context(spng_ctx_new(0));
  check(spng_set_chunk_limits(context.get(), max_chunk_bytes, max_chunk_bytes));
  check(spng_set_png_stream(context.get(), take, &source));
  spng_ihdr header{};
  check(spng_get_ihdr(context.get(), &header));
  if (header.bit_depth != 16 || header.color_type != SPNG_COLOR_TYPE_GRAYSCALE) {
    malformed(name, "not a 16-bit greyscale PNG");
  }
  const auto expected_width = static_cast<std::uint32_t>(width);
  const auto expected_height = static_cast<std::uint32_t>(height);
  if (header.width != expected_width || header.height != expected_height) {
    malformed(name, dimensions(header.width, header.height) + ", where scan.json says " +
                        dimensions(expected_width, expected_height));
  }
  DepthFrame frame{.width = width, .height = height, .depth = {}};
  frame.depth.resize(std::size_t{header.width} * header.height);
  const std::span<std::byte> image = std::as_writable_bytes(std::span(frame.depth));
  check(spng_decode_image(context.get(), image.data(), image.size(), SPNG_FMT_PNG, 0));
  check(spng_decode_chunks(context.get()));
  if (source.ran_out) {
    malformed(name, "not a whole PNG: cut short at its end");
  }
  if (!source.bytes.empty()) {
    malformed(name, "not a whole PNG: bytes after its end");
  }
  return frame;
}

void write_depth_png(const std::filesystem::path& file, const DepthFrame& frame) {
  const std::vector<std::byte> png = encode_depth_png(frame);
  std::error_code ignored;  // if the folder cannot be made, opening the file says why
  std::filesystem::create_directories(file.parent_path(), ignored);
  AtomicFile target(file);
  target.write(png);
  target.commit();
}

}  // namespace octurn
