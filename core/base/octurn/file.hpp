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

/// Reads a whole regular file of at most `max_bytes`. Never blocks, as opening a FIFO would.
///
/// @return nothing if there is no such file
/// @throws Error "file-too-large"  if it has more bytes
/// @throws Error "read-failed"     if it is not a regular file, or cannot be read
std::optional<std::string> read_regular_file(const std::filesystem::path& file,
                                             std::size_t max_bytes);

/// A file that appears whole or not at all: it is written under a temporary name beside `target`,
/// and `commit` renames it. Without `commit` the destructor removes it.
///
/// A file of more than 1 MiB bypasses the page cache where the file system allows it: this halves
/// the CPU time and leaves the machine's memory to others.
class AtomicFile {
 public:
  /// @param permissions  of the file, before the process's umask
  /// @throws Error "write-failed"  if the folder cannot be written to, or `target` is something
  ///                               else than a regular file
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
  std::unique_ptr<std::byte, void (*)(void*)> block_;  // the last bytes, not yet on the disk
  std::size_t filled_ = 0;
  std::uint64_t written_ = 0;
};

/// Writes a small file whole or not at all. @throws Error "disk-full", "write-failed"
void write_file(const std::filesystem::path& target, std::string_view content,
                unsigned permissions = 0666);

/// Syncs a folder, so that the names in it survive a power cut. @throws Error "disk-full",
/// "write-failed"
void sync_folder(const std::filesystem::path& folder);

/// A hidden name in the folder of `target`, for a file that will be renamed to `target`. It differs
/// for each process and each attempt.
///
/// @param attempt  incremented by the caller until no file of that name exists
std::filesystem::path temporary_name(const std::filesystem::path& target, int attempt);

}  // namespace octurn
