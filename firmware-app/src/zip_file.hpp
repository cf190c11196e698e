#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace octurn {

/// A file in an archive.
struct ArchivedFile {
  std::string name = {};
  std::string content = {};
};

/// Makes a zip archive of small files in memory, in the given order; `ZipWriter` is for large ones.
/// Deterministic: the same files and time give the same bytes.
/// @param time  modification time of every file; zip stores it in UTC, to two seconds, from 1980 on
std::string make_zip(std::span<const ArchivedFile> files,
                     std::chrono::system_clock::time_point time);

/// Maximum content of an archive, whose source is untrusted.
struct ZipLimits {
  std::uint64_t files = 4096;  ///< 4,000 snapshots, and the files beside them
  std::uint64_t file_bytes = std::uint64_t{32} << 20U;  ///< one file, unpacked
  std::uint64_t all_bytes = std::uint64_t{2} << 30U;    ///< all files, unpacked
};

/// Lists the names in an archive, which have '/' between folders. Uses 70 KB of stack, too much for
/// a thread of the HTTP server; so do the functions below.
/// @throws Error "bad-request"  if the archive is damaged, or has more files than the limit
std::vector<std::string> list_zip(const std::filesystem::path& archive,
                                  const ZipLimits& limits = {});

/// The path below a folder to which the entry of a name is unpacked; nullopt: it is left out. The
/// path must not lead out of the folder, whatever the name is.
using ToTarget = std::function<std::optional<std::string>(std::string_view name)>;

/// Checks the archive's list of files without unpacking any.
/// @throws Error "bad-request"  if the archive is damaged, exceeds a limit, or has a target twice
void check_zip(const std::filesystem::path& archive, const ToTarget& to_target,
               const ZipLimits& limits = {});

/// Unpacks a zip archive into an existing folder, after `check_zip`. Creates only regular files.
/// Applies the limits to the bytes that it unpacks, too: the archive may declare other sizes.
/// @throws Error as `check_zip`; "disk-full", "write-failed"; Stopped
void unpack_zip(const std::filesystem::path& archive, const std::filesystem::path& folder,
                const ToTarget& to_target, const ZipLimits& limits = {},
                const std::stop_token& stop = {});

/// Compression of a file in an archive; `stored` is for files that are compressed already.
enum class ZipMethod { stored, deflated };

/// Streams files of any size into a zip archive, which appears whole or not at all. Deterministic:
/// every file has the same date. Uses 70 KB of stack, too much for a thread of the HTTP server.
class ZipWriter {
 public:
  /// @throws Error "write-failed"
  explicit ZipWriter(std::filesystem::path target);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// Begins a file and ends the one before it. @throws Error "disk-full"
  void begin(const std::string& name, ZipMethod method);

  /// Appends to the file that was begun. @throws Error "disk-full"
  void write(std::string_view bytes);

  /// Ends the archive, syncs it to disk and renames it to its target.
  /// @throws Error "disk-full", "write-failed"
  void commit();

 private:
  struct Archive;
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::unique_ptr<Archive> archive_;
};

}  // namespace octurn
