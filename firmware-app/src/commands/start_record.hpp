#pragma once

#include <chrono>
#include <filesystem>

namespace octurn {

/// Tells whether the daemon is killed again and again soon after its start, as by a driver that a
/// broken device brings down. The file `starts` of the data folder counts the starts of this boot
/// of the machine; it goes when the daemon ends by itself, or has run for a minute.
class StartRecord {
 public:
  /// Counts this start. A folder that cannot be written to counts none.
  explicit StartRecord(const std::filesystem::path& data);
  ~StartRecord();
  StartRecord(const StartRecord&) = delete;
  StartRecord& operator=(const StartRecord&) = delete;

  /// Whether three starts before this one ended like that: the devices had better stay closed.
  bool is_safe_mode() const { return failed_starts_ >= 3; }

  /// Removes the file once a minute has passed.
  void look();

 private:
  void forget();

  std::filesystem::path file_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  int failed_starts_ = 0;
  bool is_kept_ = true;
};

}  // namespace octurn
