#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "doctor/finding.hpp"
#include "latest.hpp"

namespace octurn {

/// Health of the machine, for the status.
struct MachineHealth {
  std::uint64_t disk_free_bytes = 0;
  std::vector<Finding> warnings = {};  ///< warnings and faults
  friend bool operator==(const MachineHealth&, const MachineHealth&) = default;
};

/// Polling intervals of a MachineWatch. Free space takes one system call, the warnings a dozen
/// files; 30 s still report a failing power supply soon.
struct WatchIntervals {
  std::chrono::milliseconds disk{1000};
  std::chrono::milliseconds warnings{30'000};
};

/// Polls disk and machine on its own thread, so that a hanging disk does not block readers of the
/// status. Any thread may call `health`.
class MachineWatch {
 public:
  /// Sources of the health. The constructor calls both once, then the watch's thread does. After an
  /// exception the old values stay, and the log says why.
  struct Sources {
    std::function<std::uint64_t()> free_bytes;
    std::function<std::vector<Finding>()> warnings;
  };

  explicit MachineWatch(Sources sources, const WatchIntervals& intervals = {});

  /// Returns the same object until something changes. Touches no disk.
  std::shared_ptr<const MachineHealth> health() const { return health_.get(); }

 private:
  using Time = std::chrono::steady_clock::time_point;

  void poll(Time now);
  void run(const std::stop_token& stop);

  Sources sources_;
  WatchIntervals intervals_;
  std::optional<Time> warnings_polled_ = {};
  std::string trouble_ = {};  // why the last poll failed; empty: it succeeded
  Latest<MachineHealth> health_;
  std::jthread thread_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
