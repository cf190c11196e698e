#pragma once

#include <string_view>

namespace octurn {

/// A bar on standard error, if that is a terminal; nothing otherwise. Several threads may show.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void show(int done, int total, std::string_view doing);

 private:
  bool on_terminal_;
};

}  // namespace octurn
