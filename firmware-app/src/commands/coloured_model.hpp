#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "mesh/mesh_formats.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// A model with colours that a command is to write: first as an STL beside it, then in its format.
class ColouredModel {
 public:
  /// @throws Error "bad-settings"    if the file's name ends with no format that has colours
  /// @throws Error "scan-malformed"  if the scan has no pictures
  ColouredModel(const std::filesystem::path& file, const Scan& scan);

  /// Removes the STL.
  ~ColouredModel();
  ColouredModel(const ColouredModel&) = delete;
  ColouredModel& operator=(const ColouredModel&) = delete;

  const std::filesystem::path& stl() const { return stl_; }

  /// Writes it, whole or not at all, once the STL is there.
  /// @param folder  of the scan
  /// @throws Error "disk-full", "write-failed", "memory-limit"; Stopped
  void write(const std::filesystem::path& folder, const Scan& scan,
             const std::stop_token& stop) const;

 private:
  std::filesystem::path file_;
  std::filesystem::path stl_;
  MeshFormat format_;
};

}  // namespace octurn
