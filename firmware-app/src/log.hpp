#pragma once

#include <string>
#include <string_view>

/// Log on standard error: one line for each change of state, with a priority that systemd's journal
/// understands, or in words on a terminal. The newest lines also stay in memory, because a service
/// may not be allowed to read its own journal. Thread-safe.
namespace octurn::log {

void error(std::string_view component, std::string_view message);
void warning(std::string_view component, std::string_view message);
void info(std::string_view component, std::string_view message);

/// The newest 2000 lines of this process, the oldest first, each with its time:
/// "2026-11-21T08:15:00Z <6>scanner: ...".
std::string recent();

}  // namespace octurn::log
