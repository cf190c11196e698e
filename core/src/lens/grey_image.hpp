#pragma once

#include <cstddef>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {

/// A picture in floating point, smoothed.
struct GreyImage {
  int width = 0;                   ///< pixels
  int height = 0;                  ///< pixels
  std::vector<float> levels = {};  ///< row by row from the top left

  float at(int u, int v) const {
    return levels[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(u)];
  }

  bool holds(double u, double v) const {
    return u >= 0 && v >= 0 && u < width - 1 && v < height - 1;
  }

  /// Between four pixels, bilinear. @param u, v  that `holds`
  double between(double u, double v) const;
};

/// The picture smoothed by 1 2 1 both ways.
GreyImage smoothed(const GreyImage& image);

/// Means of blocks of side x side pixels. What is left over at the right and below is left out.
GreyImage reduced(const Picture& picture, int side);

}  // namespace octurn
