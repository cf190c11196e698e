#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

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
