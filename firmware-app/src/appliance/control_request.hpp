#pragma once

#include <chrono>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

namespace octurn {

/// How the running system is to end.
enum class PowerEnd { restart, off };

/// A request that root carries out at once: restart, power off, or a new time of the clock.
using ControlRequest = std::variant<PowerEnd, std::chrono::sys_seconds>;

/// Reads the time of a body, `{"unix_s": 1795824000}`: Unix time in seconds, from 2026 to 2100.
/// @throws Error "bad-settings"
std::chrono::sys_seconds clock_from(const nlohmann::json& body);

/// The line that root reads: "restart", "off" or "clock 1764012345".
std::string to_text(const ControlRequest& request);

}  // namespace octurn
