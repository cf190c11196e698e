#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string_view>

namespace octurn {

/// Maximum content of an archive, whose source is untrusted.
struct ZipLimits {
  std::uint64_t files = 4096;  ///< 4,000 snapshots, and the files beside them
  std::uint64_t file_bytes = std::uint64_t{32} << 20U;  ///< one file, unpacked
  std::uint64_t all_bytes = std::uint64_t{2} << 30U;    ///< all files, unpacked
};

/// Whether an entry may have this name, which has '/' between folders.
using IsAllowedName = std::function<bool(std::string_view name)>;

/// Checks the archive's list of files without unpacking any. Uses 70 KB of stack, too much for a
/// thread of the HTTP server.
/// @throws Error "bad-request"  if the archive is damaged, exceeds a limit, or has a name twice or
///               one that is not allowed
void check_zip(const std::filesystem::path& archive, const IsAllowedName& is_allowed,
               const ZipLimits& limits = {});

/// Unpacks a zip archive into an existing folder, after `check_zip`. Creates only regular files.
/// Applies the limits to the bytes that it unpacks, too: the archive may declare other sizes. Uses
/// 70 KB of stack.
/// @throws Error as `check_zip`; "disk-full", "write-failed"; Stopped
void unpack_zip(const std::filesystem::path& archive, const std::filesystem::path& folder,
                const IsAllowedName& is_allowed, const ZipLimits& limits = {},
                const std::stop_token& stop = {});

}  // namespace octurn
