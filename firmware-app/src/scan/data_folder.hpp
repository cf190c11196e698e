#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

#include "file_descriptor.hpp"
#include "scan/scan_settings.hpp"

namespace octurn {

/// What a scan with these settings takes on the disk at most.
std::uint64_t max_scan_bytes(const ScanSettings& settings);

/// What a model takes on the disk at most, but for the finest.
std::uint64_t max_model_bytes();

/// @param what  is to be written, such as "a model"
/// @throws Error "disk-full"  if `needed` bytes of it may not fit into those that are free
void expect_room(const std::filesystem::path& data, std::uint64_t available, std::uint64_t needed,
                 const std::string& what);

/// The folder, or the nearest one above it that exists.
std::filesystem::path existing_part(std::filesystem::path folder);

/// What may still be written into a folder, or where it would be made. @throws Error "data-failed"
std::uint64_t free_bytes_in(const std::filesystem::path& folder);

/// Whether a program works in that folder of scans just now.
bool is_in_use(const std::filesystem::path& data);

/// Takes a folder of scans for this process, as long as the result is open. Works on a disk that
/// became read-only, whose scans can still be served.
/// @throws Error "data-in-use" if another process has it, "data-failed"
FileDescriptor lock_data_folder(const std::filesystem::path& data);

/// The names in a folder; those that could be read, if the disk fails meanwhile.
std::vector<std::string> names_in(const std::filesystem::path& folder);

/// Removes what begins with a dot: temporary files, and folders that were not finished.
void clear_unfinished(const std::filesystem::path& folder);

/// Removes what `write_file` began and did not finish of the JSON files beside the scans. What else
/// begins with a dot there stays: the folder may be somebody's home.
void clear_unfinished_json(const std::filesystem::path& data);

/// @throws Error "disk-full" or "data-failed", always
[[noreturn]] void throw_data_error(const std::filesystem::path& path, const std::string& doing,
                                   std::error_code reason);

}  // namespace octurn
