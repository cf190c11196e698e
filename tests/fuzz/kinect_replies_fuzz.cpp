#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "kinect/camera_commands.hpp"
#include "octurn/error.hpp"

// The input is a list of the camera's answers: a byte for its length, doubled, then its bytes; the
// length 255 is a failed transfer. A command's tag is put into answers that are long enough, or
// else none would be taken. When the list ends, or after some answers, between which the driver
// waits, the device is gone. Parameters that are read make sense.

namespace {

struct Gone {};

constexpr int max_answers = 8;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace octurn;
  std::span<const std::uint8_t> input(data, size);
  std::uint8_t tag = 0;
  int answers = 0;
  CameraCommands commands({.write =
                               [&](auto message, auto /*timeout*/) {
                                 tag = message[6];
                                 return static_cast<int>(message.size());
                               },
                           .read =
                               [&](std::span<std::uint8_t> reply, auto /*timeout*/) {
                                 if (input.empty() || ++answers > max_answers) {
                                   throw Gone();
                                 }
                                 const std::uint8_t told = input[0];
                                 input = input.subspan(1);
                                 if (told == 255) {
                                   return -1;
                                 }
                                 const std::size_t bytes =
                                     std::min({std::size_t{2} * told, input.size(), reply.size()});
                                 std::ranges::copy(input.first(bytes), reply.begin());
                                 input = input.subspan(bytes);
                                 if (bytes > 6) {
                                   reply[6] = tag;
                                 }
                                 return static_cast<int>(bytes);
                               }});
  try {
    const KinectParameters parameters =
        commands.parameters(CameraCommands::Clock::now() + std::chrono::seconds(10));
    if (!std::isfinite(parameters.focal_length()) || parameters.focal_length() <= 0) {
      std::abort();
    }
    depth_table(parameters);
  } catch (const Error&) {
    return 0;
  } catch (const Gone&) {
    return 0;
  }
  return 0;
}
