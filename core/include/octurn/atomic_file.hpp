#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace octurn {

/// A file that appears whole or not at all: written under a temporary name beside `target`, and
/// given its real name by `commit`. Destroyed before that, it leaves nothing behind.
///
/// A large file goes past the page cache, where the file system allows it: that takes half the CPU
/// time, and leaves the machine's memory to others.
class AtomicFile {
 public:
  /// @param permissions  of the file, less what the process withholds from all (umask)
  /// @throws Error  if the folder cannot be written to
  explicit AtomicFile(std::filesystem::path target, unsigned permissions = 0666);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. @throws Error  if the disk is full or does not take it
  void write(std::span<const std::byte> bytes);

  /// Overwrites bytes, from `offset`. @throws Error  as above
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);

  /// Syncs the file, renames it over `target`, and syncs the folder. @throws Error  as above
  void commit();

  const std::filesystem::path& temporary() const { return temporary_; }

 private:
  void flush();
  void put(std::uint64_t offset, std::span<const std::byte> bytes);
  bool go_past_cache(bool past);

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
  std::unique_ptr<std::byte, void (*)(void*)> block_;  // what comes after the bytes written so far
  std::size_t filled_ = 0;
  std::uint64_t written_ = 0;
};

/// Makes the names in a folder survive a power cut. @throws Error  if the disk does not take it
void sync_folder(const std::filesystem::path& folder);

/// Writes a small file whole or not at all. @throws Error  if the disk does not take it
void write_file(const std::filesystem::path& target, std::string_view content,
                unsigned permissions = 0666);

}  // namespace octurn
