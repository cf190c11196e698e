#pragma once

#include <string_view>

/// One line for a change of state, on standard error, with the priority that the journal reads.
namespace octurn::log {

void error(std::string_view component, std::string_view message);
void warning(std::string_view component, std::string_view message);
void info(std::string_view component, std::string_view message);

}  // namespace octurn::log
