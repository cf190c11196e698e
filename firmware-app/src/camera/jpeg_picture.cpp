#include "camera/jpeg_picture.hpp"

#include <turbojpeg.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <memory>
#include <new>
#include <string_view>
#include <utility>

namespace octurn {
namespace {

struct EndDecompressor {
  void operator()(void* decompressor) const { ::tjDestroy(decompressor); }
};
using Decompressor = std::unique_ptr<void, EndDecompressor>;

// A baseline JPEG has one scan. One with thousands of them would take minutes.
constexpr int flags = TJFLAG_LIMITSCANS;

/// Whether a warning tells of bytes too many before a marker, as few as cameras are known to leave.
/// More of them are what is left where the decoder lost its place.
bool is_harmless(std::string_view warning) {
  constexpr std::string_view before = "Corrupt JPEG data: ";
  constexpr std::string_view after = " extraneous bytes before marker";
  constexpr int most_bytes = 8;
  if (!warning.starts_with(before)) {
    return false;
  }
  warning.remove_prefix(before.size());
  int bytes = 0;
  const auto end = std::from_chars(warning.data(), warning.data() + warning.size(), bytes).ptr;
  warning.remove_prefix(static_cast<std::size_t>(end - warning.data()));
  return bytes <= most_bytes && warning.starts_with(after);
}

/// The decoder tells the first of its warnings alone, which may be a harmless one.
bool has_end(std::span<const std::uint8_t> bytes) {
  constexpr std::array<std::uint8_t, 2> end_of_image = {0xff, 0xd9};
  return std::find_end(bytes.begin(), bytes.end(), end_of_image.begin(), end_of_image.end()) !=
         bytes.end();
}

/// A JPEG of the size, before its pixels are decoded.
class JpegReader {
 public:
  JpegReader(std::span<const std::uint8_t> bytes, int width, int height)
      : bytes_(bytes), decompressor_(::tjInitDecompress()) {
    if (!decompressor_) {
      throw std::bad_alloc();
    }
    int own_width = 0;
    int own_height = 0;
    int colour_space = 0;
    is_readable_ =
        has_end(bytes) &&
        is_whole(::tjDecompressHeader3(decompressor_.get(), bytes.data(), bytes.size(), &own_width,
                                       &own_height, &subsampling_, &colour_space)) &&
        own_width == width && own_height == height &&
        (colour_space == TJCS_YCbCr || colour_space == TJCS_GRAY);
  }

  bool is_readable() const { return is_readable_; }
  int subsampling() const { return subsampling_; }

  /// @param pixels  width x height
  /// @return whether the picture is whole
  bool read_luminance(std::span<std::uint8_t> pixels, int width, int height) const {
    return is_whole(::tjDecompress2(decompressor_.get(), bytes_.data(), bytes_.size(),
                                    pixels.data(), width, width, height, TJPF_GRAY, flags));
  }

  /// @return whether the picture is whole
  bool read_planes(std::array<unsigned char*, 3> planes, std::array<int, 3> strides, int width,
                   int height) const {
    return is_whole(::tjDecompressToYUVPlanes(decompressor_.get(), bytes_.data(), bytes_.size(),
                                              planes.data(), width, strides.data(), height, flags));
  }

 private:
  bool is_whole(int result) const {
    return result == 0 || (::tjGetErrorCode(decompressor_.get()) == TJERR_WARNING &&
                           is_harmless(::tjGetErrorStr2(decompressor_.get())));
  }

  std::span<const std::uint8_t> bytes_;
  Decompressor decompressor_;
  bool is_readable_ = false;
  int subsampling_ = TJSAMP_GRAY;
};

PixelLayout layout_of(int subsampling) {
  switch (subsampling) {
    case TJSAMP_444:
      return PixelLayout::yuv444;
    case TJSAMP_422:
      return PixelLayout::yuv422;
    case TJSAMP_420:
      return PixelLayout::yuv420;
    default:
      return PixelLayout::grey;
  }
}

}  // namespace

std::optional<Picture> grey_jpeg(std::span<const std::uint8_t> bytes, int width, int height) {
  const JpegReader reader(bytes, width, height);
  if (!reader.is_readable()) {
    return std::nullopt;
  }
  Picture picture{.width = width, .height = height};
  picture.samples.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  if (!reader.read_luminance(picture.samples, width, height)) {
    return std::nullopt;
  }
  return picture;
}

std::optional<JpegPlanes> jpeg_planes(std::span<const std::uint8_t> bytes, int width, int height) {
  const JpegReader reader(bytes, width, height);
  if (!reader.is_readable()) {
    return std::nullopt;
  }
  const PixelLayout layout = layout_of(reader.subsampling());
  if (layout == PixelLayout::grey) {
    std::optional<Picture> picture = grey_jpeg(bytes, width, height);
    if (!picture) {
      return std::nullopt;
    }
    return JpegPlanes{.rows = {.layout = layout,
                               .width = width,
                               .height = height,
                               .stride = static_cast<std::size_t>(width)},
                      .planes = {std::move(picture->samples)}};
  }
  const int stride = width + width % 2;  // twice that of a plane that is half as wide
  JpegPlanes picture{.rows = {.layout = layout,
                              .width = width,
                              .height = height,
                              .stride = static_cast<std::size_t>(stride)}};
  std::array<unsigned char*, 3> begins = {};
  std::array<int, 3> strides = {};
  for (std::size_t i = 0; i < strides.size(); ++i) {
    const bool is_half = i > 0 && layout != PixelLayout::yuv444;
    strides[i] = is_half ? stride / 2 : stride;
    const int rows = ::tjPlaneHeight(static_cast<int>(i), height, reader.subsampling());
    picture.planes[i].resize(static_cast<std::size_t>(strides[i]) * static_cast<std::size_t>(rows));
    begins[i] = picture.planes[i].data();
  }
  if (!reader.read_planes(begins, strides, width, height)) {
    return std::nullopt;
  }
  return picture;
}

}  // namespace octurn
