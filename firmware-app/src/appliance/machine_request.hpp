#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace octurn {

/// The machine's name and time zone, as root reports them.
struct MachineState {
  std::string name = {};       ///< the page is at http://NAME.local
  std::string time_zone = {};  ///< "Europe/Berlin"; empty: UTC
  std::string error = {};      ///< what is wrong with the last request, or empty
};

/// A change of the name, the time zone or both.
struct MachineRequest {
  std::optional<std::string> name = {};
  std::optional<std::string> time_zone = {};
};

/// Reads {"name", "time_zone"}.
/// @throws Error "bad-settings"  that names the key; also if the body has neither
MachineRequest machine_request_from(const nlohmann::json& body);

/// The request as lines of octurn.txt.
std::string to_text(const MachineRequest& request);

}  // namespace octurn
