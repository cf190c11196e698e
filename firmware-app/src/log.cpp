#include "log.hpp"

#include <unistd.h>

#include <chrono>
#include <mutex>
#include <string>

#include "progress_bar.hpp"
#include "wall_clock.hpp"

namespace octurn {

void LogRing::add(std::string_view line) {
  lines_.emplace_back(line.substr(0, max_line_bytes_));
  if (lines_.size() > max_lines_) {
    lines_.pop_front();
  }
}

std::string LogRing::text() const {
  std::string all;
  for (const std::string& line : lines_) {
    all.append(line).append("\n");
  }
  return all;
}

}  // namespace octurn

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

/// The start of a line for people: it replaces a progress bar that is drawn there.
std::string terminal_prefix(char priority) {
  return std::string(clear_line) + (priority == '3'   ? "error: "
                                    : priority == '4' ? "warning: "
                                                      : "");
}

/// Writes the line in one system call, so that lines of different threads do not mix.
void write_line(char priority, std::string_view component, std::string_view message) {
  const std::string said = std::string(component).append(": ").append(message);
  const std::string journal_prefix = std::string("<").append(1, priority).append(">");
  const std::string line =
      (::isatty(STDERR_FILENO) == 1 ? terminal_prefix(priority) : journal_prefix) + said + "\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());

  const std::string time = utc_text(std::chrono::system_clock::now(), rfc3339);
  const std::lock_guard lock(kept().mutex);
  kept().lines.add(time + " " + journal_prefix + said);
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
