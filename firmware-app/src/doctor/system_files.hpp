#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace octurn {

// Small files of /sys and /proc. A missing file or folder is no error.

/// Paths of a folder's entries, sorted by name.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

/// The first line of a file, without line feed.
std::optional<std::string> first_line(const std::filesystem::path& file);

/// The number at the beginning of a file.
std::optional<double> number_in(const std::filesystem::path& file);

/// Whether this process may read and write a file or device.
bool may_use(const std::filesystem::path& file);

}  // namespace octurn
