#include "log.hpp"

#include <unistd.h>

#include <chrono>
#include <mutex>
#include <string>

#include "log_ring.hpp"
#include "utc.hpp"

namespace octurn::log {
namespace {

struct Kept {
  std::mutex mutex;  // guards lines
  LogRing lines{2000, 512};
};

Kept& kept() {
  static Kept all;
  return all;
}

/// Writes the line in one system call, so that lines of different threads do not mix.
void write_line(char priority, std::string_view component, std::string_view message) {
  std::string line = "<";
  line.append(1, priority).append(">").append(component).append(": ").append(message).append("\n");
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());

  line.pop_back();
  const std::string time = utc_text(std::chrono::system_clock::now(), rfc3339);
  const std::lock_guard lock(kept().mutex);
  kept().lines.add(time + " " + line);
}

}  // namespace

// Priorities of syslog(3); sd-daemon(3) reads them as a prefix of the line.
void error(std::string_view component, std::string_view message) {
  write_line('3', component, message);
}

void warning(std::string_view component, std::string_view message) {
  write_line('4', component, message);
}

void info(std::string_view component, std::string_view message) {
  write_line('6', component, message);
}

std::string recent() {
  const std::lock_guard lock(kept().mutex);
  return kept().lines.text();
}

}  // namespace octurn::log
