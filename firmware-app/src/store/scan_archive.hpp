#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <stop_token>
#include <string_view>

namespace octurn {

/// Whether a scan's archive may contain a file of that name: `scan.json`, `job.json`, the texts of
/// its label, `sensor-map.png`, and PNGs in `snapshots/`.
bool is_scan_file(std::string_view name);

/// Writes the captured data of a scan, without its models, to a zip archive, from which another
/// Octurn makes the same model. The same scan gives the same bytes.
/// @throws Error "disk-full", "write-failed", "read-failed"
void write_scan_archive(const std::filesystem::path& scan, const std::filesystem::path& archive);

/// Bytes of an archive that another program sends.
struct ArchiveSource {
  std::uint64_t bytes = 0;  ///< as announced
  /// Fills a buffer from its start. @return bytes read; 0 at the end
  std::function<std::size_t(std::span<std::byte>)> read = {};
};

/// Writes the bytes of an archive to a file as they arrive.
/// @param check_room  called before that many bytes more are written
/// @throws Error "cut-short"  if fewer bytes arrive than were announced; "disk-full",
///               "write-failed"; Stopped
void receive_archive(const ArchiveSource& source, const std::filesystem::path& target,
                     const std::function<void(std::uint64_t bytes)>& check_room,
                     const std::stop_token& stop);

/// Checks an archive's list of files. Uses 70 KB of stack.
/// @throws Error "bad-request"  if it is no archive of a scan
void check_archive_files(const std::filesystem::path& archive);

/// Unpacks such an archive into an existing folder, and checks it by decoding each of its pictures
/// once. Bounded for untrusted archives: takes up to 100 MB of memory, and refuses scans of more
/// than `stored_ranges.max_snapshots` snapshots. Uses 70 KB of stack.
/// @throws Error "bad-request"  if the scan is incomplete or damaged, or exceeds a limit;
///               "disk-full", "write-failed"; Stopped
void read_scan_archive(const std::filesystem::path& archive, const std::filesystem::path& scan,
                       const std::stop_token& stop = {});

}  // namespace octurn
