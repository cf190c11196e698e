#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

namespace octurn {

/// What an archive may hold at most: it may come from anybody.
struct ZipLimits {
  std::uint64_t files = 4000;
  std::uint64_t file_bytes = std::uint64_t{32} << 20U;  ///< of one file, unpacked
  std::uint64_t all_bytes = std::uint64_t{2} << 30U;    ///< of all of them
};

/// Unpacks a zip archive into a folder that exists. Nothing but regular files of allowed names is
/// made, each once, and no more is written than the limits allow, whatever the archive says of
/// itself. Takes 70 KB of stack, which the threads of the HTTP server have not got.
/// @param is_allowed  tells of a name, with '/' between folders, whether it may be in the archive
/// @throws Error "bad-request"  if it is no whole archive, or is not as allowed; "disk-full",
///               "write-failed"
void unpack_zip(const std::filesystem::path& archive, const std::filesystem::path& folder,
                const std::function<bool(std::string_view name)>& is_allowed,
                const ZipLimits& limits = {});

}  // namespace octurn
