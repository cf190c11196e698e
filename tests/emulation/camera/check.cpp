// Takes pictures with the camera driver, on the machine of `machine`. camera.test.mjs checks its
// output, makes the pictures, and unplugs the camera where the output asks for it.

#include <dlfcn.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "camera/camera.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

void say(const std::string& text) { std::cout << "check: " << text << std::endl; }

/// Counts wrong pixels. The first pixel is the picture's number; the pixel at (x, y) is x + 2 y
/// more, with x and y in blocks. Colours must be grey, as the camera sends none.
/// @param block  side of a uniform block, pixels
std::size_t wrong_pixels(const TimedPicture& timed, int block) {
  const Picture& picture = timed.picture;
  std::size_t wrong = 0;
  for (std::size_t at = 0; at < timed.colours.size(); ++at) {
    const std::uint8_t level = picture.samples[at];
    wrong += timed.colours[at] == Rgb{level, level, level} ? 0 : 1;
  }
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto at = static_cast<std::size_t>(y * picture.width + x);
      wrong += picture.samples[at] ==
                       static_cast<std::uint8_t>(picture.samples[0] + x / block + 2 * (y / block))
                   ? 0
                   : 1;
    }
  }
  return wrong;
}

void take(Camera& camera, int count, int block) {
  steady_clock::time_point last = {};
  for (int i = 0; i < count; ++i) {
    const bool is_in_colour = i % 2 == 1;
    const std::optional<TimedPicture> timed =
        is_in_colour ? camera.read_in_colour({}) : camera.read({});
    if (!timed) {
      say("stopped");
      return;
    }
    if (timed->colours.size() != (is_in_colour ? timed->picture.samples.size() : 0)) {
      say("colours that were not asked for, or none that were");
    }
    const bool is_later = timed->begin > last && timed->begin < steady_clock::now();
    last = timed->begin;
    say("picture " + std::to_string(timed->picture.samples[0]) + " of " +
        std::to_string(timed->picture.width) + " x " + std::to_string(timed->picture.height) +
        ", " + std::to_string(wrong_pixels(*timed, block)) + " pixels wrong, begun " +
        (is_later ? "in order" : "out of order"));
  }
}

/// Reads until an error is thrown.
void take_until_it_fails(Camera& camera) {
  while (camera.read({})) {
  }
}

/// @param then  the fault after some pictures; empty: none
void check(const CameraModule& module, const CameraSettings& as, int block,
           const std::string& then) {
  try {
    const std::unique_ptr<Camera> camera = module.open(as);
    say("camera " + camera->name() + ", serial " + camera->serial());
    take(*camera, 8, block);
    if (then.empty()) {
      return;
    }
    say(then);
    take_until_it_fails(*camera);
  } catch (const Error& error) {
    say("error " + std::string(to_string(error.code())) + ": " + error.what() + " (" +
        error.hint() + ")");
  }
}

}  // namespace
}  // namespace octurn

// usage: check MODULE, or check MODULE WIDTH HEIGHT for pictures of blocks of this size alone
int main(int count, char** arguments) {
  using namespace octurn;
  void* const loaded = ::dlopen(arguments[1], RTLD_NOW);
  const void* const found = loaded == nullptr ? nullptr : ::dlsym(loaded, "octurn_camera");
  if (found == nullptr) {
    say(::dlerror());
    return 1;
  }
  const auto& module = *static_cast<const CameraModule*>(found);
  if (count == 4) {
    check(module, {.width = std::atoi(arguments[2]), .height = std::atoi(arguments[3])}, 8, "");
    return 0;
  }
  const CameraSettings plain{.width = 400, .height = 304};
  const CameraSettings compressed{.width = 800, .height = 600};
  const CameraSettings fast_if_compressed{.width = 512, .height = 384};
  check(module, {.width = 640, .height = 616}, 1, "");
  check(module, plain, 1, "be silent");
  check(module, plain, 1, "be damaged");
  check(module, compressed, 8, "be cut");
  check(module, fast_if_compressed, 8, "be silent");
  check(module, plain, 1, "unplug");
  return 0;
}
