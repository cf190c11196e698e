#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "file_descriptor.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// Maximum bytes of a scan with these settings on the disk.
std::uint64_t max_scan_bytes(const ScanSettings& settings);

/// Bytes of a model on the disk; only the finest models take more.
std::uint64_t max_model_bytes();

/// Checks that there is enough free space on the disk.
/// @param what  what is to be written, such as "a model"
/// @throws Error "disk-full"  if the `needed` bytes exceed the `available` ones
void expect_room(const std::filesystem::path& data, std::uint64_t available, std::uint64_t needed,
                 const std::string& what);

/// Returns the folder, or its nearest existing ancestor.
std::filesystem::path existing_part(std::filesystem::path folder);

/// Returns the free bytes on the disk of a folder that need not exist. @throws Error "data-failed"
std::uint64_t free_bytes_in(const std::filesystem::path& folder);

/// Whether another process has locked that folder of scans.
bool is_in_use(const std::filesystem::path& data);

/// Locks a folder of scans for this process, as long as the result is open. This works on a
/// read-only disk, too, so that its scans can still be served.
/// @throws Error "data-in-use" if another process holds the lock; "data-failed"
FileDescriptor lock_data_folder(const std::filesystem::path& data);

/// Lists the names in a folder; if the disk fails, the names read so far.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// Removes entries whose names begin with a dot: temporary files and unfinished folders.
void clear_unfinished(const std::filesystem::path& folder);

/// Removes temporary files that `write_file` left of the JSON files beside the scans. Other hidden
/// files stay: the folder may be somebody's home.
void clear_unfinished_json(const std::filesystem::path& data);

/// Throws Error "disk-full" or "data-failed". @param doing  completes "cannot ..."
[[noreturn]] void throw_data_error(const std::filesystem::path& path, const std::string& doing,
                                   std::error_code reason);

}  // namespace octurn
