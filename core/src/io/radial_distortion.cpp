#include "io/radial_distortion.hpp"

#include <algorithm>

namespace octurn {
namespace {

constexpr int max_iterations = 12;    // 4 are enough for a webcam's lens
constexpr int max_steps = 256;        // along a radius
constexpr double min_slope = 0.05;    // below it the picture is compressed more than 20-fold
constexpr double max_widening = 4.0;  // undistorted over distorted radius

}  // namespace

double RadialDistortion::undistorting_factor(double distorted_radius) const {
  if (distorted_radius < 1e-9) {
    return 1;
  }
  double r = distorted_radius;
  for (int i = 0; i < max_iterations; ++i) {
    const double step = (distorted(r) - distorted_radius) / std::max(slope(r), min_slope);
    r = std::clamp(r - step, 0.0, max_widening * distorted_radius);
    if (step < 1e-12 && step > -1e-12) {
      break;
    }
  }
  return r / distorted_radius;
}

bool RadialDistortion::is_invertible_to(double distorted_radius) const {
  const double last = max_widening * distorted_radius;
  for (int i = 0; i <= max_steps; ++i) {
    const double r = last * i / max_steps;
    if (!(slope(r) > min_slope)) {
      return false;
    }
    if (distorted(r) >= distorted_radius) {
      return true;
    }
  }
  return false;
}

}  // namespace octurn
