#pragma once

#include <cstddef>
#include <deque>
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

namespace octurn {

/// Ring of the newest log lines, of bounded size. Not thread-safe.
class LogRing {
 public:
  /// @param max_line_bytes  longer lines are cut there
  LogRing(std::size_t max_lines, std::size_t max_line_bytes)
      : max_lines_(max_lines), max_line_bytes_(max_line_bytes) {}

  /// Appends a line, and drops the oldest if there are too many. @param line  without line feed
  void add(std::string_view line);

  /// The lines, the oldest first, each with a line feed.
  std::string text() const;

 private:
  std::size_t max_lines_;
  std::size_t max_line_bytes_;
  std::deque<std::string> lines_ = {};
};

}  // namespace octurn
