#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "octurn/png.hpp"

namespace octurn {

/// Pixels. Larger pictures are reduced to about this width to detect corners; limits in pixels hold
/// for it.
inline constexpr int usual_width = 820;

/// A grey picture in floating point.
struct GreyImage {
  int width = 0;                   ///< pixels
  int height = 0;                  ///< pixels
  std::vector<float> levels = {};  ///< row by row from the top left

  float at(int u, int v) const {
    return levels[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(u)];
  }

  bool contains(double u, double v) const {
    return u >= 0 && v >= 0 && u < width - 1 && v < height - 1;
  }

  /// Interpolates between four pixels (bilinear). @param u, v  inside the image, see `contains`
  double bilinear(double u, double v) const;
};

/// Smooths an image by the binomial filter 1 2 1 along both axes.
GreyImage smoothed(const GreyImage& image);

/// Reduces a picture to the means of blocks of side x side pixels. Incomplete blocks at the right
/// and the bottom are dropped.
GreyImage reduced(const Picture& picture, int side);
GreyImage reduced(const GreyImage& image, int side);

/// The place in a picture of a pixel of the reduced one: a block's centre lies (side - 1) / 2
/// pixels from the centre of its first pixel.
inline Eigen::Vector2d to_whole(const Eigen::Vector2d& pixel, int side) {
  return pixel * side + Eigen::Vector2d::Constant((side - 1) / 2.0);
}

}  // namespace octurn
