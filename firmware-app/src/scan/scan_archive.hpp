#pragma once

#include <filesystem>
#include <string_view>

namespace octurn {

/// Whether a scan's archive may contain a file of that name: `scan.json`, `job.json`, `name.txt`,
/// `notes.txt`, `sensor-map.png`, and PNGs in `snapshots/`.
bool is_scan_file(std::string_view name);

/// Writes the captured data of a scan, without its models, to a zip archive, from which another
/// Octurn makes the same model. The same scan gives the same bytes.
/// @throws Error "disk-full", "write-failed", "read-failed"
void write_scan_archive(const std::filesystem::path& scan, const std::filesystem::path& archive);

/// Unpacks such an archive into an existing folder, and checks it by reading every snapshot.
/// @throws Error "bad-request"  if the scan is incomplete or damaged; "disk-full", "write-failed"
void read_scan_archive(const std::filesystem::path& archive, const std::filesystem::path& scan);

}  // namespace octurn
