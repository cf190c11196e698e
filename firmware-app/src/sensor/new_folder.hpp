#pragma once

#include <filesystem>

namespace octurn {

/// A folder that appears whole or not at all: under a temporary name beside its own until it is
/// committed. Destroyed before that, it leaves nothing behind.
class NewFolder {
 public:
  /// @throws Error "write-failed"  if the folder exists or cannot be made
  explicit NewFolder(std::filesystem::path folder);
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

  /// Where its files are until it is committed.
  const std::filesystem::path& path() const { return temporary_; }

  /// Gives the folder its name; returns when it is on the disk. @throws Error "write-failed"
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path temporary_;
};

}  // namespace octurn
