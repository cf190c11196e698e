#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
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

// Checks of the machine. `root` is the folder with /proc, /sys and /run: "/" except in tests.

/// Whether the page's settings are as they were stored.
/// @param trouble  of ConfigStore
Finding check_settings(const std::string& trouble);

/// Disk space of a scan, in bytes.
struct ScanBytes {
  std::uint64_t largest = 0;  ///< maximum; a scan starts only with this much free
  std::uint64_t usual = 0;    ///< expected size of a finished scan
};

/// Whether the disk has room for several scans.
/// @param free  bytes that this program may still write into the data folder
Finding check_disk(std::uint64_t free, const ScanBytes& scan);

/// Whether the memory that a reconstruction may use is available.
/// @param limit  bytes, for the whole process; 0 is no limit
Finding check_memory(const std::filesystem::path& root, std::size_t limit);

/// Whether the processor is cool enough to keep its clock.
Finding check_temperature(const std::filesystem::path& root);

/// Whether a Raspberry Pi's supply voltage has stayed above 4.63 V. Nothing where the kernel does
/// not tell: Raspberry Pi's own does, Debian's has no driver for it.
std::optional<Finding> check_supply(const std::filesystem::path& root);

/// Whether a Raspberry Pi's firmware has lowered the clock of the processor. Nothing where the
/// kernel does not tell.
std::optional<Finding> check_throttling(const std::filesystem::path& root);

/// Whether the clock is right. A Raspberry Pi has no clock that runs without power.
/// @param synchronised  as `is_clock_synchronised` says
Finding check_clock(const std::filesystem::path& root, std::chrono::system_clock::time_point now,
                    bool synchronised);

// Checks of this program's permissions. `root` is the folder with /dev and /sys: "/" except in
// tests.

/// Whether a supported sensor is on USB, and this user may open it.
Finding check_usb(const std::filesystem::path& root);

/// Whether this user may open the GPIO chips.
Finding check_gpio_permission(const std::filesystem::path& root);

/// Whether this user may write into the data folder, or create it.
Finding check_data_folder(const std::filesystem::path& data);

/// Whether the stepper's thread gets real-time priority.
/// @param refusal  the kernel's reason against it; empty if it allows it
Finding check_real_time(const std::string& refusal);

// Small files of /sys and /proc. A missing file or folder is no error.

/// Paths of a folder's entries, sorted by name.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

/// The first line of a file, without line feed.
std::optional<std::string> first_line(const std::filesystem::path& file);

/// The number at the beginning of a file.
std::optional<double> number_in(const std::filesystem::path& file);

/// Whether this process may read and write a file or device.
bool may_use(const std::filesystem::path& file);

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
