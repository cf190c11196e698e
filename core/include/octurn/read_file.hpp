#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

namespace octurn {

/// Reads a whole file. Never waits for a writer, as opening a FIFO would, and never holds more than
/// `max_bytes`.
///
/// @return nothing if there is no such file
/// @throws Error "read-failed"  if it is no regular file, is larger, or the disk does not give it
std::optional<std::string> read_regular_file(const std::filesystem::path& file,
                                             std::size_t max_bytes);

}  // namespace octurn
