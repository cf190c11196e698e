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
#include "scan/latest.hpp"

namespace octurn {

/// How the machine is, told without being asked for.
struct MachineHealth {
  std::uint64_t disk_free_bytes = 0;
  std::vector<Finding> warnings = {};  ///< warnings and faults
  friend bool operator==(const MachineHealth&, const MachineHealth&) = default;
};

/// How often a MachineWatch looks. Free space is one system call; the warnings read a dozen files,
/// and a supply that fails is still told soon.
struct WatchIntervals {
  std::chrono::milliseconds disk{1000};
  std::chrono::milliseconds warnings{30'000};
};

/// Looks at the disk and the machine again and again, on a thread of its own: a disk that hangs
/// keeps no reader of the status waiting. Any thread may call `health`.
class MachineWatch {
 public:
  /// Both are called on the watch's thread, after a first time on the caller's. A figure that
  /// cannot be read stays as it was, and the log tells why.
  struct Looks {
    std::function<std::uint64_t()> free_bytes;
    std::function<std::vector<Finding>()> warnings;
  };

  explicit MachineWatch(Looks looks, const WatchIntervals& intervals = {});

  /// The same object for as long as nothing has changed. Touches no disk.
  std::shared_ptr<const MachineHealth> health() const { return health_.get(); }

 private:
  using Time = std::chrono::steady_clock::time_point;

  void look(Time now);
  void run(const std::stop_token& stop);

  Looks looks_;
  WatchIntervals intervals_;
  std::optional<Time> warnings_looked_ = {};
  std::string trouble_ = {};  // why the last look failed; empty: it did not
  Latest<MachineHealth> health_;
  std::jthread thread_;  // the last member, so that it ends before what it uses goes away
};

}  // namespace octurn
