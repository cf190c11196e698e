#pragma once

#include <chrono>
#include <filesystem>

namespace octurn {

/// Detects a crash loop: a daemon that dies soon after each start, for example in the driver of a
/// broken device. The file `starts` in the data folder counts the starts of this boot of the
/// machine. It is removed when the daemon ends normally, or has run for a minute.
class StartRecord {
 public:
  /// Counts this start, or logs that it is not counted if the folder cannot be written to.
  explicit StartRecord(const std::filesystem::path& data);
  ~StartRecord();
  StartRecord(const StartRecord&) = delete;
  StartRecord& operator=(const StartRecord&) = delete;

  /// Whether at least three starts before this one crashed. The devices should then stay closed.
  bool is_safe_mode() const { return failed_starts_ >= 3; }

  /// Removes the file if a minute has passed since the start.
  void remove_when_stable();

 private:
  void forget();

  std::filesystem::path file_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  int failed_starts_ = 0;
  bool is_kept_ = true;
};

}  // namespace octurn
