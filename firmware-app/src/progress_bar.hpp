#pragma once

#include <string_view>

namespace octurn {

/// Erases the line of a terminal on which a progress bar may be.
inline constexpr const char* clear_line = "\r\033[K";

/// Progress bar on standard error; prints nothing if that is no terminal. Thread-safe.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Redraws the bar. @param doing  label after the numbers
  void show(int done, int total, std::string_view doing);

  bool on_terminal() const { return on_terminal_; }

 private:
  bool on_terminal_;
};

}  // namespace octurn
