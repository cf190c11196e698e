#include "camera/pixel_formats.hpp"

#include <libcamera/formats.h>
#include <libcamera/property_ids.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "camera/frame_rate.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using libcamera::PixelFormat;
using libcamera::Size;

// What needs the least work first; of a camera with colours grey is the last. libcamera names
// colours by the bits of a little-endian word: BGR888 has red first in memory.
using Readable = std::array<std::pair<PixelFormat, PixelLayout>, 9>;
const Readable readable = {{
    {libcamera::formats::R8, PixelLayout::grey},
    {libcamera::formats::NV12, PixelLayout::nv12},
    {libcamera::formats::NV21, PixelLayout::nv21},
    {libcamera::formats::YUV420, PixelLayout::yuv420},
    {libcamera::formats::YVU420, PixelLayout::yvu420},
    {libcamera::formats::YUYV, PixelLayout::yuyv},
    {libcamera::formats::UYVY, PixelLayout::uyvy},
    {libcamera::formats::BGR888, PixelLayout::rgb_bytes},
    {libcamera::formats::RGB888, PixelLayout::bgr_bytes},
}};

const PixelFormat compressed = libcamera::formats::MJPEG;

Readable readable_of(const libcamera::Camera& camera) {
  Readable formats = readable;
  const auto filter = camera.properties().get(libcamera::properties::draft::ColorFilterArrangement);
  if (filter != libcamera::properties::draft::MONO) {
    std::rotate(formats.begin(), formats.begin() + 1, formats.end());
  }
  return formats;
}

std::string size_text(const Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

/// The sizes that a stream has in formats that are read, the largest first.
std::vector<Size> sizes_of(const libcamera::StreamConfiguration& stream) {
  std::vector<Size> sizes;
  const auto add = [&](const PixelFormat& format) {
    for (const Size& size : stream.formats().sizes(format)) {
      if (std::ranges::find(sizes, size) == sizes.end()) {
        sizes.push_back(size);
      }
    }
  };
  add(compressed);
  for (const auto& [format, layout] : readable) {
    add(format);
  }
  std::ranges::sort(sizes, [](const Size& a, const Size& b) {
    return std::size_t{a.width} * a.height > std::size_t{b.width} * b.height;
  });
  return sizes;
}

[[noreturn]] void refuse(const libcamera::StreamConfiguration& stream, const Size& wanted,
                         const std::string& camera) {
  const std::vector<Size> sizes = sizes_of(stream);
  if (sizes.empty()) {
    throw Error(ErrorCode::sensor_other, camera + ": none of its formats can be read",
                "Use a camera that sends pictures without compression, or as MJPEG.");
  }
  std::string others;
  for (const Size& size : sizes) {
    others += (others.empty() ? "" : ", ") + size_text(size);
  }
  throw Error(
      ErrorCode::sensor_other, camera + ": it makes no pictures of " + size_text(wanted),
      "Set laser.width and laser.height to a size of its own, and the other keys of its lens: "
      "it has " +
          others + ".");
}

/// Sets the stream to the format, if the camera makes pictures of the size in it.
bool set_format(libcamera::CameraConfiguration& configuration, const PixelFormat& format,
                const Size& size) {
  libcamera::StreamConfiguration& stream = configuration.at(0);
  const std::vector<PixelFormat> offered = stream.formats().pixelformats();
  if (std::ranges::find(offered, format) == offered.end()) {
    return false;
  }
  stream.pixelFormat = format;
  stream.size = size;
  stream.colorSpace = libcamera::ColorSpace::Sycc;  // all levels, and BT.601 as is computed with
  // What is validated may be adjusted: to another size, or another format.
  return configuration.validate() != libcamera::CameraConfiguration::Invalid &&
         stream.size == size && stream.pixelFormat == format;
}

/// Whether the camera makes fewer pictures than a scan wants in a format, and more if compressed.
bool is_too_slow(const PixelFormat& format, const Size& size, const libcamera::Camera& camera) {
  constexpr double wanted_hz = 15;  // for which a scan's length is stated
  const auto devices = video_devices(camera.id());
  const auto rate_hz = [&](const PixelFormat& of) {
    return fastest_rate_hz(devices, of.fourcc(), size.width, size.height);
  };
  const double as_is_hz = rate_hz(format);
  return as_is_hz < wanted_hz && rate_hz(compressed) > as_is_hz;
}

}  // namespace

std::optional<PixelLayout> choose_format(libcamera::CameraConfiguration& configuration,
                                         const CameraSettings& settings,
                                         const libcamera::Camera& camera, const std::string& name) {
  const Size size(static_cast<unsigned>(settings.width), static_cast<unsigned>(settings.height));
  for (const auto& [format, layout] : readable_of(camera)) {
    if (set_format(configuration, format, size)) {
      if (is_too_slow(format, size, camera) && set_format(configuration, compressed, size)) {
        return std::nullopt;
      }
      if (set_format(configuration, format, size)) {
        return layout;
      }
    }
  }
  if (set_format(configuration, compressed, size)) {
    return std::nullopt;
  }
  refuse(configuration.at(0), size, name);
}

}  // namespace octurn
