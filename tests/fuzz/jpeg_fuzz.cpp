#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "camera/colour_picture.hpp"
#include "camera/jpeg_picture.hpp"

// Any bytes sent as a JPEG give no picture, or one of the camera's size whose luminance is the same
// whether its colours are decoded or not.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace octurn;
  constexpr int width = 37;
  constexpr int height = 21;
  const std::span<const std::uint8_t> bytes(data, size);
  const auto picture = grey_jpeg(bytes, width, height);
  const auto jpeg = jpeg_planes(bytes, width, height);
  if (!jpeg) {
    return 0;
  }
  const std::vector<std::span<const std::uint8_t>> planes(jpeg->planes.begin(), jpeg->planes.end());
  const Picture seen = grey_picture(planes.front(), jpeg->rows);
  const std::vector<Rgb> colours = colour_picture(planes, jpeg->rows);
  constexpr std::size_t pixels = std::size_t{width} * height;
  if (seen.samples.size() != pixels || (!colours.empty() && colours.size() != pixels) ||
      (picture && picture->samples != seen.samples)) {
    std::abort();
  }
  return 0;
}
