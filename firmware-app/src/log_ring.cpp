#include "log_ring.hpp"

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
