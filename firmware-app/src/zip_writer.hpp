#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace octurn {

/// How a file is held in an archive: what is packed already is not packed again.
enum class ZipMethod { stored, deflated };

/// A zip archive of files of any size, written as they come, that appears whole or not at all.
/// Deterministic: every file has the same date. Takes 70 KB of stack, which the threads of the HTTP
/// server have not got.
class ZipWriter {
 public:
  /// @throws Error "write-failed"
  explicit ZipWriter(std::filesystem::path target);
  ~ZipWriter();
  ZipWriter(const ZipWriter&) = delete;
  ZipWriter& operator=(const ZipWriter&) = delete;

  /// Begins a file; the one before it is done. @throws Error "disk-full"
  void begin(const std::string& name, ZipMethod method);

  /// Appends to the file that was begun. @throws Error "disk-full"
  void write(std::string_view bytes);

  /// Ends the archive and gives it its name. @throws Error "disk-full", "write-failed"
  void commit();

 private:
  struct Archive;
  std::filesystem::path target_;
  std::filesystem::path temporary_;
  std::unique_ptr<Archive> archive_;
};

}  // namespace octurn
