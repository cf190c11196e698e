#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace octurn {

/// Compression of a file in an archive; `stored` is for files that are compressed already.
enum class ZipMethod { stored, deflated };

/// Streams files of any size into a zip archive, which appears whole or not at all. Deterministic:
/// every file has the same date. Uses 70 KB of stack, too much for a thread of the HTTP server.
class ZipWriter {
 public:
  /// @throws Error "write-failed"
  explicit ZipWriter(std::filesystem::path target);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// Begins a file and ends the one before it. @throws Error "disk-full"
  void begin(const std::string& name, ZipMethod method);

  /// Appends to the file that was begun. @throws Error "disk-full"
  void write(std::string_view bytes);

  /// Ends the archive, syncs it to disk and renames it to its target.
  /// @throws Error "disk-full", "write-failed"
  void commit();

 private:
  struct Archive;
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::unique_ptr<Archive> archive_;
};

}  // namespace octurn
