#pragma once

#include <optional>
#include <string>

#include "failure.hpp"

namespace octurn {

/// The devices as of the worker's last use of them. The worker sets them for the decisions of other
/// threads; the StatusBoard shows more of them, for display.
struct DeviceStates {
  bool sensor_is_ready = false;
  std::string serial = {};  ///< of the sensor opened last; empty: none yet, or it has none
  bool turntable_is_ready = false;
  std::optional<Failure> turntable_failure = {};
};

}  // namespace octurn
