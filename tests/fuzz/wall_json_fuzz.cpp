#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/sensor_map.hpp"

// Any text is refused by an Error, or gives a wall whose frames lie in its folder.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace octurn;
  Wall wall;
  try {
    wall = parse_wall(std::string_view(reinterpret_cast<const char*>(data), size));
  } catch (const Error&) {
    return 0;
  }
  for (const std::string& frame : wall.frames) {
    const std::filesystem::path path = std::filesystem::path(frame).lexically_normal();
    if (path.is_absolute() || *path.begin() == "..") {
      std::abort();
    }
  }
  if (wall.frames.empty() || wall.intrinsics.width < 2 || wall.intrinsics.height < 2) {
    std::abort();
  }
  return 0;
}
