#pragma once

#include <Eigen/Core>
#include <vector>

#include "lens/grey_image.hpp"

namespace octurn {

/// A place of a picture where four squares may meet.
struct CornerFeature {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  float response = 0;  ///< grey levels
};

/// ChESS features of a smoothed image, the strongest first: maxima of the response among the pixels
/// around, at most 2000.
std::vector<CornerFeature> corner_features(const GreyImage& image);

/// Moves a corner to where the gradients around it say that it is: the sum of w g (g . (p - x)) is
/// zero, g being the gradient at pixel p, w a Gaussian about x.
/// @param reach  pixels from the corner to the side of the window, less than a square's side
/// @return false if they do not tell, or it would move out of the picture or by more than `reach`
bool refine_corner(const GreyImage& image, int reach, Eigen::Vector2d& pixel);

}  // namespace octurn
