#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <stop_token>
#include <string>
#include <vector>

#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "capture/take_depth_image.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Turns a rig with lasers to a stop and takes its pictures into a scan folder. Each is written
/// while the next one is taken; all of them, and the scan.json that names them, are on the disk
/// when this returns.
///
/// @param angle  of the platform there, radians
/// @return false if stopped first
/// @throws Error  as `take_pictures`, and "disk-full", "write-failed"
bool take_stop(Rig& rig, const Stop& at, double angle, const std::filesystem::path& folder,
               Scan& scan, const std::stop_token& stop, const ScanObserver& observer);

/// Writes the pictures of one stop, each while the camera takes the next one. The destructor waits
/// for the one that is written.
class PictureWriter {
 public:
  /// @param folder  of the scan
  /// @param files   of the stop's pictures in it, in the order in which they are added
  PictureWriter(std::filesystem::path folder, std::vector<std::string> files);

  /// Begins to write the next picture, as RGB if any pixel has a colour.
  /// @param colours  of its pixels; empty if the camera has none
  /// @throws Error "disk-full", "write-failed"  of the picture before
  void add(Picture picture, std::vector<Rgb> colours);

  /// Returns when all are on the disk. @throws Error  as above
  void finish();

 private:
  std::filesystem::path folder_;
  std::vector<std::string> files_;
  std::size_t added_ = 0;
  std::future<void> writing_;  // at most one picture
};

}  // namespace octurn
