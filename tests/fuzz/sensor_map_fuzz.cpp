#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "octurn/error.hpp"
#include "octurn/sensor_map.hpp"

// Any bytes are refused by an Error, or give a sensor map that survives a round trip through
// encoder and decoder.

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace octurn;
  SensorMap map;
  try {
    map = decode_sensor_map("input", std::as_bytes(std::span(data, size)));
  } catch (const Error&) {
    return 0;
  }
  const SensorMap again = decode_sensor_map("again", encode_sensor_map(map));
  if (again.width != map.width || again.height != map.height || again.near != map.near ||
      again.far != map.far || again.far_inverse_depth != map.far_inverse_depth) {
    std::abort();
  }
  return 0;
}
