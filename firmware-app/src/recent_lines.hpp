#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <string_view>

namespace octurn {

/// The last of many lines, in bounded memory. Not thread-safe.
class RecentLines {
 public:
  /// @param longest  bytes that are kept of a line
  RecentLines(std::size_t most_lines, std::size_t longest)
      : most_lines_(most_lines), longest_(longest) {}

  /// @param line  without its end
  void add(std::string_view line);

  /// All that are kept, the oldest first, each with its end.
  std::string text() const;

 private:
  std::size_t most_lines_;
  std::size_t longest_;
  std::deque<std::string> lines_ = {};
};

}  // namespace octurn
