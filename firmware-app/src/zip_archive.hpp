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

/// Makes a zip archive of small files in memory, in the given order; `ZipWriter` is for large ones.
/// Deterministic: the same files and time give the same bytes.
/// @param time  modification time of every file; zip stores it in UTC, to two seconds, from 1980 on
std::string make_zip(std::span<const ArchivedFile> files,
                     std::chrono::system_clock::time_point time);

}  // namespace octurn
