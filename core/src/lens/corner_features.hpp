#pragma once

#include <Eigen/Core>
#include <vector>

#include "lens/grey_image.hpp"

namespace octurn {

/// A candidate corner: a pixel where four squares may meet.
struct CornerFeature {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  float response = 0;  ///< grey levels
};

/// ChESS features of a smoothed image: the local maxima of the response, at most 2000, the
/// strongest first.
std::vector<CornerFeature> corner_features(const GreyImage& image);

/// Refines a corner x to sub-pixel accuracy: the sum of w g (g . (p - x)) over a window is zero,
/// where g is the gradient at pixel p and w a Gaussian about x (Foerstner and Guelch 1987).
/// @param reach  half side of the window, pixels; less than a square's side
/// @return false if the gradients do not determine a corner, or it would move out of the picture or
/// by more than `reach`
bool refine_corner(const GreyImage& image, int reach, Eigen::Vector2d& pixel);

}  // namespace octurn
