#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

namespace octurn {

/// Maximum content of an archive, whose source is untrusted.
struct ZipLimits {
  std::uint64_t files = 4000;
  std::uint64_t file_bytes = std::uint64_t{32} << 20U;  ///< one file, unpacked
  std::uint64_t all_bytes = std::uint64_t{2} << 30U;    ///< all files, unpacked
};

/// Unpacks a zip archive into an existing folder. Creates only regular files with allowed names,
/// each once. Applies the limits to the bytes that it unpacks, not to the sizes that the archive
/// declares. Uses 70 KB of stack, too much for a thread of the HTTP server.
/// @param is_allowed  whether an entry may have this name, which has '/' between folders
/// @throws Error "bad-request"  if the archive is damaged, exceeds a limit, or has a name twice or
///               one that is not allowed; "disk-full", "write-failed"
void unpack_zip(const std::filesystem::path& archive, const std::filesystem::path& folder,
                const std::function<bool(std::string_view name)>& is_allowed,
                const ZipLimits& limits = {});

}  // namespace octurn
