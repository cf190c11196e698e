#include "calibrate/platform_wobble.hpp"

#include <cmath>

namespace octurn {

using Eigen::Vector2d;

std::optional<PlatformWobble> measure_wobble(const std::vector<StopPlane>& planes,
                                             const std::vector<double>& angles) {
  if (planes.empty()) {
    return std::nullopt;
  }
  std::vector<Vector2d> tilts;  // in the frame that turns with the platform
  tilts.reserve(planes.size());
  Vector2d mean = Vector2d::Zero();
  for (std::size_t stop = 0; stop < planes.size(); ++stop) {
    tilts.emplace_back(Eigen::Rotation2Dd(-angles[stop]) * planes[stop].tilt);
    mean += tilts.back();
  }
  const auto stops = static_cast<double>(planes.size());
  mean /= stops;
  double squares = 0;
  for (const Vector2d& tilt : tilts) {
    squares += (tilt - mean).squaredNorm();
  }
  return PlatformWobble{.angle = mean.norm(),
                        .sigma = std::sqrt(squares / (2 * (stops - 1)) / stops)};
}

}  // namespace octurn
