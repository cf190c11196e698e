#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "file_descriptor.hpp"
#include "scan/job.hpp"

namespace octurn {

/// Whether a text has the form of a scan's name in paths: "20261121-081500-3f2a". Nothing else may
/// become part of a path.
bool is_scan_id(std::string_view text);

/// What a scan with these settings takes on the disk at most.
std::uint64_t most_bytes_of(const ScanSettings& settings);

/// The folder, or the nearest one above it that exists.
std::filesystem::path existing_part(std::filesystem::path folder);

/// What may still be written into a folder, or where it would be made. @throws Error "data-failed"
std::uint64_t free_bytes_in(const std::filesystem::path& folder);

/// Whether a program works in that folder of scans just now.
bool is_in_use(const std::filesystem::path& data);

/// The scans on the disk: `DATA/scans/<id>/` with a scan folder, `Scan.stl`, `job.json` (what was
/// asked for and what became of it) and `name.txt` (what a person called it). And
/// `DATA/platform.json`, which tells where the platform stands.
///
/// Holds nothing but the path. Each file appears whole or not at all and has one writer (the worker
/// those of the scan, an HTTP thread the name and what ends a paused scan), so any thread may call
/// anything at any time.
class ScanStore {
 public:
  /// Takes hold of the folder, clears away what a dead process left unfinished, and marks the scans
  /// that it was making as interrupted.
  /// @throws Error "data-in-use" if another process holds it; if it cannot be made or written to
  explicit ScanStore(std::filesystem::path data);

  /// Makes the folder of a new scan, in state running. Its id comes after every other's, even where
  /// the clock has gone back.
  /// @throws Error "disk-full" if a scan of that many snapshots may not fit
  Job create(const ScanSettings& settings) const;

  /// Writes `job.json`.
  void save(const Job& job) const;

  /// All scans, newest first. One whose `job.json` cannot be read is listed as failed.
  std::vector<Job> list() const;
  std::optional<Job> find(std::string_view id) const;

  /// The newest finished scan, if there is one.
  std::optional<Job> newest_finished() const;

  /// @throws Error "no-such-scan"
  void rename(std::string_view id, std::string_view name) const;
  void remove(std::string_view id) const;

  /// @param id  that exists
  std::filesystem::path folder(std::string_view id) const;
  std::filesystem::path model_file(std::string_view id) const { return folder(id) / "Scan.stl"; }

  /// Where the platform was when it was written down last, degrees; 0 if it never was.
  double platform_angle_deg() const;
  void save_platform_angle_deg(double angle_deg) const;

  std::uint64_t free_bytes() const;

 private:
  std::vector<std::string> ids_newest_first() const;
  void recover() const;

  std::filesystem::path data_;
  std::filesystem::path scans_;
  std::filesystem::path platform_;
  FileDescriptor lock_;  // locked while it is open
};

}  // namespace octurn
