#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>

namespace octurn {

/// A file without a name, for what does not fit in memory: it is gone when the process ends,
/// however that happens. Several threads may read at once.
class UnnamedFile {
 public:
  /// @param folder  on whose disk it lies. @throws Error "write-failed"
  explicit UnnamedFile(const std::filesystem::path& folder);
  ~UnnamedFile();
  UnnamedFile(const UnnamedFile&) = delete;
  UnnamedFile& operator=(const UnnamedFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// @throws Error "disk-full", "write-failed"
  void append(std::span<const std::byte> bytes);

  /// Reads what was appended. @throws Error "read-failed"
  void read(std::uint64_t offset, std::span<std::byte> bytes) const;

 private:
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace octurn
