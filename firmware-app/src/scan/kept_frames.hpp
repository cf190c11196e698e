#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// A cache of decoded depth images, for those that are read twice. Keeps the rectangle with
/// readings of as many images as fit.
class KeptFrames {
 public:
  /// @param count  of the images. @param max_bytes  that they may take
  KeptFrames(std::size_t count, std::size_t max_bytes);

  /// Keeps an image if there is room. Called by several threads at once for different ones.
  void keep(std::size_t index, const DepthFrame& frame);

  /// The image as it was; nothing if it is not kept.
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
