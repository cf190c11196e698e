#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace octurn {

/// What this machine is called and which time it has, as root answers.
struct MachineState {
  std::string name = {};       ///< the page is at http://NAME.local
  std::string time_zone = {};  ///< "Europe/Berlin"; empty: UTC
  std::string error = {};      ///< what is wrong with the last request, or empty
};

/// What shall be changed of it.
struct MachineRequest {
  std::optional<std::string> name = {};
  std::optional<std::string> time_zone = {};
};

/// @throws Error "bad-settings"  that names the key; also if nothing is to be changed
MachineRequest machine_request_from(const nlohmann::json& body);

/// Lines of octurn.txt.
std::string to_text(const MachineRequest& request);

}  // namespace octurn
