#pragma once

#include <string>
#include <string_view>

/// One line for a change of state, on standard error, with the priority that the journal reads. The
/// last ones are kept, since not every service may read its journal. Any thread may call anything.
namespace octurn::log {

void error(std::string_view component, std::string_view message);
void warning(std::string_view component, std::string_view message);
void info(std::string_view component, std::string_view message);

/// The last 2000 lines of this process, the oldest first, each with its time:
/// "2026-11-21T08:15:00Z <6>scanner: ...".
std::string recent();

}  // namespace octurn::log
