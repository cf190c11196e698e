#include "io/grey_png.hpp"
#include "octurn/png.hpp"

namespace octurn {
namespace {

PngSource of_snapshot(std::string_view name, std::span<const std::byte> png) {
  return {.name = name,
          .bytes = png,
          .malformed = ErrorCode::snapshot_malformed,
          .hint = "The file is damaged, or not written by a scan."};
}

/// Returns a function that refuses any other image size. @param source  must outlive the function
auto expects(const PngSource& source, int width, int height) {
  return [&source, width, height](std::uint32_t w, std::uint32_t h) {
    const auto expected_width = static_cast<std::uint32_t>(width);
    const auto expected_height = static_cast<std::uint32_t>(height);
    if (w != expected_width || h != expected_height) {
      source.refuse(size_text(w, h) + ", where scan.json says " +
                    size_text(expected_width, expected_height));
    }
  };
}

}  // namespace

std::vector<std::byte> encode_depth_png(const DepthFrame& frame) {
  return encode_grey_png(frame.width, frame.height, std::span(frame.depth), {});
}

std::vector<std::byte> encode_grey_png(int width, int height,
                                       std::span<const std::uint8_t> samples) {
  return encode_grey_png(width, height, samples, {});
}

DepthFrame decode_depth_png(std::string_view name, std::span<const std::byte> png, int width,
                            int height) {
  const PngSource source = of_snapshot(name, png);
  GreyPng image = decode_grey16_png(source, "", expects(source, width, height));
  return {.width = width, .height = height, .depth = std::move(image.samples)};
}

Picture decode_picture_png(std::string_view name, std::span<const std::byte> png, int width,
                           int height) {
  const PngSource source = of_snapshot(name, png);
  return {.width = width,
          .height = height,
          .samples = decode_luminance_png(source, expects(source, width, height))};
}

ColourPicture decode_rgb_png(std::string_view name, std::span<const std::byte> png, int width,
                             int height) {
  const PngSource source = of_snapshot(name, png);
  return {.width = width,
          .height = height,
          .pixels = decode_rgb_png(source, expects(source, width, height))};
}

void write_depth_png(const std::filesystem::path& file, const DepthFrame& frame) {
  write_png(file, encode_depth_png(frame));
}

}  // namespace octurn
