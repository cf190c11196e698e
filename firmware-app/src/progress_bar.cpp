#include "progress_bar.hpp"

#include <unistd.h>

#include <iostream>
#include <string>

namespace octurn {

namespace {

constexpr int width = 30;  // characters

}  // namespace

ProgressBar::ProgressBar() : on_terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (on_terminal_) {
    std::cerr << clear_line;
  }
}

void ProgressBar::show(int done, int total, std::string_view doing) {
  if (!on_terminal_) {
    return;
  }
  const auto full = static_cast<std::size_t>(total > 0 ? width * done / total : 0);
  std::string line = clear_line;
  line += '[' + std::string(full, '#') + std::string(width - full, '.') + "] ";
  line += std::to_string(done) + '/' + std::to_string(total) + ' ';
  line += doing;
  std::cerr << line << std::flush;  // one write, so that threads do not mix their lines
}

}  // namespace octurn
