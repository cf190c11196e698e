#pragma once

#include <filesystem>

namespace octurn {

/// A folder that appears whole or not at all. It has a temporary name beside its own until it is
/// committed; the destructor removes an uncommitted one.
class NewFolder {
 public:
  /// @throws Error "write-failed"  if the folder exists or cannot be made
  explicit NewFolder(std::filesystem::path folder);
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  /// The temporary folder, to write files into.
  const std::filesystem::path& path() const { return temporary_; }

  /// Renames the folder to its own name; returns once it is on disk. @throws Error "write-failed"
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path temporary_;
};

}  // namespace octurn
