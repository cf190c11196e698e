#include "laser/line_profile.hpp"

#include <cmath>
#include <limits>

#include "io/radial_distortion.hpp"

namespace octurn {
namespace {

constexpr double nearest_line = 0.03;  // metres in front of the camera
constexpr double farthest_line = 3.0;  // no line is seen farther away
constexpr double min_sine = 0.02;      // of the angle between ray and plane

}  // namespace

LineProfile to_profile(std::span<const LineSample> samples, const Intrinsics& lens,
                       const LaserCamera& camera) {
  const RadialDistortion distortion{.k1 = camera.k1, .k2 = camera.k2};
  LineProfile profile;
  profile.rays.reserve(samples.size());
  profile.rows.reserve(static_cast<std::size_t>(lens.height) + 1);
  for (const LineSample& sample : samples) {
    while (static_cast<int>(profile.rows.size()) <= sample.row) {
      profile.rows.push_back(static_cast<std::int32_t>(profile.rays.size()));
    }
    const double x = (static_cast<double>(sample.u) - lens.cx) / lens.fx;
    const double y = (sample.row - lens.cy) / lens.fy;
    const double factor = distortion.undistorting_factor(std::sqrt(x * x + y * y));
    profile.rays.push_back({.x = static_cast<float>(x * factor),
                            .y = static_cast<float>(y * factor),
                            .next = sample.next});
  }
  profile.rows.resize(static_cast<std::size_t>(lens.height) + 1,
                      static_cast<std::int32_t>(profile.rays.size()));
  return profile;
}

Eigen::Vector3d meet(const LineProfile::Ray& ray, const Laser& laser) {
  const double x = static_cast<double>(ray.x);
  const double y = static_cast<double>(ray.y);
  const double across = laser.normal.x() * x + laser.normal.y() * y + laser.normal.z();
  const double z = laser.distance / across;
  const bool is_met = std::abs(across) > min_sine * std::sqrt(x * x + y * y + 1) &&
                      z > nearest_line && z < farthest_line;
  if (!is_met) {
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return {x * z, y * z, z};
}

}  // namespace octurn
