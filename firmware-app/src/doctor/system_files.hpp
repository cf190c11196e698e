#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace octurn {

// The small files of /sys and /proc. What is not there is nothing, and no error.

/// What is in a folder, by name.
std::vector<std::filesystem::path> entries(const std::filesystem::path& folder);

std::optional<std::string> first_line(const std::filesystem::path& file);

/// The number that a file begins with.
std::optional<double> number_in(const std::filesystem::path& file);

/// Whether this process may read and write a file or device.
bool may_use(const std::filesystem::path& file);

}  // namespace octurn
