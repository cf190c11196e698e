#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace octurn {

/// A temporary file without a name, for data that does not fit in memory. It disappears when the
/// process ends, even by a crash. Several threads may read at once.
class UnnamedFile {
 public:
  /// @param folder  on the disk that is to hold the file. @throws Error "disk-full", "write-failed"
  explicit UnnamedFile(const std::filesystem::path& folder);
  ~UnnamedFile();
  UnnamedFile(const UnnamedFile&) = delete;
  UnnamedFile& operator=(const UnnamedFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// @throws Error "disk-full", "write-failed"
  void append(std::span<const std::byte> bytes);

  /// Reads appended bytes. @throws Error "read-failed"
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace octurn
