#include "log.hpp"

#include <unistd.h>

#include <string>

namespace octurn::log {
namespace {

/// Writes the line in one call, so that lines of different threads do not mix.
void write_line(char priority, std::string_view component, std::string_view message) {
  std::string line = "<";
  line.append(1, priority).append(">").append(component).append(": ").append(message).append("\n");
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
}

}  // namespace

// The digits are those of syslog(3), which sd-daemon(3) takes at the start of a line.
void error(std::string_view component, std::string_view message) {
  write_line('3', component, message);
}

void warning(std::string_view component, std::string_view message) {
  write_line('4', component, message);
}

void info(std::string_view component, std::string_view message) {
  write_line('6', component, message);
}

}  // namespace octurn::log
