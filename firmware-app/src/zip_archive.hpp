#pragma once

#include <chrono>
#include <span>
#include <string>

namespace octurn {

/// A file in an archive.
struct ArchivedFile {
  std::string name = {};
  std::string content = {};
};

/// A zip archive of small files, in their order. The same files and time give the same bytes.
/// @param time  of each of them, kept to two seconds, in UTC; not before 1980, as zip has it
std::string zip_of(std::span<const ArchivedFile> files, std::chrono::system_clock::time_point time);

}  // namespace octurn
