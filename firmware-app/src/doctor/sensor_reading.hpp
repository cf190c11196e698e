#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "capture/rig.hpp"
#include "octurn/snapshot.hpp"
#include "rig/packet_counts.hpp"
#include "rig/tilt.hpp"
#include "store/job.hpp"

namespace octurn {

/// Frames and properties of a sensor, taken for about two seconds.
struct SensorSample {
  std::string name = {};
  std::string serial = {};
  Intrinsics intrinsics = {};
  std::vector<std::chrono::steady_clock::time_point> times = {};  ///< of each frame
  std::optional<PacketCounts> packets = {};  ///< nothing if the sensor does not count them
  std::vector<DepthFrame> frames = {};       ///< the last ones, of a scene that stands still
  std::optional<Tilt> tilt = {};
};

/// A camera with lasers that sees the lines of all of them.
struct CameraSample {
  std::string name = {};
  int width = 0;  ///< pixels
  int height = 0;
  std::vector<std::string> lasers = {};  ///< their names
};

/// A sample, or why there is none. The code "busy" says that the sensor is in use.
using SensorReading = std::variant<SensorSample, CameraSample, Failure>;

/// Reads frames for about two seconds, or takes a picture with each laser where the platform
/// stands; "busy" if `stop` is requested before. Closes a sensor that fails.
SensorReading read_sensor(Rig& rig, const std::stop_token& stop);

}  // namespace octurn
