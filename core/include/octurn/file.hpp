#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace octurn {

/// Reads a whole file. Never waits for a writer, as opening a FIFO would, and never holds more than
/// `max_bytes`.
///
/// @return nothing if there is no such file
/// @throws Error "file-too-large"  if it has more
/// @throws Error "read-failed"     if it is no regular file, or the disk does not give it
std::optional<std::string> read_regular_file(const std::filesystem::path& file,
                                             std::size_t max_bytes);

/// A file that appears whole or not at all: written under a temporary name beside `target`, and
/// given its real name by `commit`. Destroyed before that, it leaves nothing behind.
///
/// A file of more than 1 MiB bypasses the page cache where the file system allows it: that halves
/// the CPU time and leaves the machine's memory to others.
class AtomicFile {
 public:
  /// @param permissions  of the file, less the process's umask
  /// @throws Error "write-failed"  if the folder cannot be written to, or `target` is no regular
  ///                               file
  explicit AtomicFile(std::filesystem::path target, unsigned permissions = 0666);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. @throws Error "disk-full", "write-failed"
  void write(std::span<const std::byte> bytes);

  /// Overwrites bytes, from `offset`. @throws Error  as `write`
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);

  /// Syncs the file, renames it over `target`, and syncs the folder. @throws Error  as `write`
  void commit();

  const std::filesystem::path& temporary() const { return temporary_; }

 private:
  void flush();
  void put(std::uint64_t offset, std::span<const std::byte> bytes);
  bool set_direct(bool direct);

  std::filesystem::path target_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
  std::unique_ptr<std::byte, void (*)(void*)> block_;  // bytes that follow those on the disk
  std::size_t filled_ = 0;
  std::uint64_t written_ = 0;
};

/// Writes a small file whole or not at all. @throws Error "disk-full", "write-failed"
void write_file(const std::filesystem::path& target, std::string_view content,
                unsigned permissions = 0666);

/// Makes the names in a folder survive a power cut. @throws Error "disk-full", "write-failed"
void sync_folder(const std::filesystem::path& folder);

/// A hidden name in the folder of `target`, for what will be renamed to it. Names of two processes
/// differ, and so do those of two attempts.
///
/// @param attempt  counted up by the caller until nothing of that name exists
std::filesystem::path temporary_name(const std::filesystem::path& target, int attempt);

}  // namespace octurn
