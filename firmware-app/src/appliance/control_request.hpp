#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

namespace octurn {

/// How a machine is to end.
enum class PowerEnd { restart, off };

/// What root is asked to do with the machine at once: to end it, or to set its clock.
using ControlRequest = std::variant<PowerEnd, std::chrono::sys_seconds>;

/// The time of a body, `{"unix_s": 1764012345}`: seconds since 1970, of this century.
/// @throws Error "bad-settings"
std::chrono::sys_seconds clock_from(const nlohmann::json& body);

/// The line that root reads: "restart", "off" or "clock 1764012345".
std::string to_text(const ControlRequest& request);

}  // namespace octurn
