#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "octurn/error.hpp"
#include "sensor/recording.hpp"

// Any text is refused by an Error of one line, or gives a recording from which a sensor can be
// made.

namespace {

void require(bool promise) {
  if (!promise) {
    std::abort();
  }
}

void check(const octurn::Recording& recording) {
  const octurn::Intrinsics& intrinsics = recording.intrinsics;
  require(intrinsics.width > 0 && intrinsics.height > 0);
  require(intrinsics.fx > 0 && intrinsics.fy > 0 && intrinsics.depth_unit > 0);
  require(!recording.frames.empty());
  for (const octurn::RecordedFrame& frame : recording.frames) {
    require(std::isfinite(frame.time.count()) && frame.time.count() >= 0);
    require(std::isfinite(frame.angle));
    require(!frame.tilt || (std::isfinite(frame.tilt->pitch) && std::isfinite(frame.tilt->roll)));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    check(octurn::parse_recording({reinterpret_cast<const char*>(data), size}));
  } catch (const octurn::Error& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
