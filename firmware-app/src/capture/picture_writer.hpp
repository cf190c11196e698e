#pragma once

#include <cstddef>
#include <filesystem>
#include <future>
#include <string>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {

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
