#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// A cache of decoded depth images that are read twice. It stores each image cropped to the
/// bounding box of its readings, until its memory is full.
class KeptFrames {
 public:
  /// @param count      number of images
  /// @param max_bytes  maximum size of the stored images
  KeptFrames(std::size_t count, std::size_t max_bytes);

  /// Stores an image if there is room. Threads may store images of different indices at the same
  /// time.
  void keep(std::size_t index, const DepthFrame& frame);

  /// Returns the whole image; nullopt if it is not stored.
  std::optional<DepthFrame> find(std::size_t index) const;

 private:
  struct Window {
    int width = 0;   // of the image
    int height = 0;  // of the image
    int left = 0;
    int top = 0;
    int columns = 0;
    std::vector<std::uint16_t> depth = {};  // row by row
  };

  std::vector<std::optional<Window>> windows_;
  std::atomic<std::size_t> room_;  // bytes
};

}  // namespace octurn
