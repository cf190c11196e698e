#pragma once

#include <filesystem>
#include <optional>
#include <stop_token>

#include "mesh/mesh_formats.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Writes a model with colours in two steps: an STL beside the file, then the file itself.
class ColouredModel {
 public:
  /// @throws Error "bad-settings"    if the file's extension is not of a format with colours
  /// @throws Error "scan-malformed"  if the scan has no pictures
  ColouredModel(const std::filesystem::path& file, const Scan& scan);

  /// Removes the STL.
  ~ColouredModel();
  ColouredModel(const ColouredModel&) = delete;
  ColouredModel& operator=(const ColouredModel&) = delete;

  const std::filesystem::path& stl() const { return stl_; }

  /// Colours the finished STL and writes the file, which appears whole or not at all.
  /// @param folder  of the scan
  /// @throws Error "disk-full", "write-failed", "memory-limit"; Stopped
  void write(const std::filesystem::path& folder, const Scan& scan,
             const std::stop_token& stop) const;

 private:
  std::filesystem::path file_;
  std::filesystem::path stl_;
  const MeshFormat& format_;
};

}  // namespace octurn
