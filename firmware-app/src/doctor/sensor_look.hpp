#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "octurn/depth_frame.hpp"
#include "rig/tilt.hpp"
#include "scan/job.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// What a sensor gave in about two seconds.
struct SensorSample {
  std::string name = {};
  Intrinsics intrinsics = {};
  std::vector<std::chrono::steady_clock::time_point> times = {};  ///< of each frame
  std::optional<int> damaged = {};      ///< frames that came damaged; nothing if it does not count
  std::vector<DepthFrame> frames = {};  ///< the last ones, of a scene that stands still
  std::optional<Tilt> tilt = {};
};

/// That, or why there is none. Its code is "busy" where the sensor may not be looked at now.
using SensorLook = std::variant<SensorSample, Failure>;

/// Reads frames for about two seconds; "busy" if stopped before.
SensorLook look_at_sensor(Rig& rig, const std::stop_token& stop);

}  // namespace octurn
