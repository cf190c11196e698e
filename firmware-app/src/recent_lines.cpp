#include "recent_lines.hpp"

namespace octurn {

void RecentLines::add(std::string_view line) {
  lines_.emplace_back(line.substr(0, longest_));
  if (lines_.size() > most_lines_) {
    lines_.pop_front();
  }
}

std::string RecentLines::text() const {
  std::string all;
  for (const std::string& line : lines_) {
    all.append(line).append("\n");
  }
  return all;
}

}  // namespace octurn
