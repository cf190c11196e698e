#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace octurn {

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

}  // namespace octurn
