#include "simulator/sensor_unit.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/camera.hpp"
#include "simulator/surface.hpp"
#include "simulator/white_noise.hpp"

namespace octurn {
namespace {

/// Pixels of the pinhole picture beyond each edge: k1 of -0.2 shows the corners 30 pixels further
/// out.
constexpr int beyond_picture = 32;

/// Inverts the distortion: the normalised coordinates of a pinhole camera that appear at `shown`.
Eigen::Vector2d undistorted(const SensorOptics& optics, const Eigen::Vector2d& shown) {
  constexpr int steps = 30;  // each leaves less than a third of the error
  Eigen::Vector2d ray = shown;
  for (int i = 0; i < steps; ++i) {
    const double square = ray.squaredNorm();
    ray = shown / (1 + square * (optics.k1 + square * optics.k2));
  }
  return ray;
}

/// The inverse depth between pixels: of one surface it is affine, and at an edge the nearest
/// pixel's.
float between(const InverseDepth& picture, int width, double u, double v) {
  const auto left = static_cast<int>(u);
  const auto top = static_cast<int>(v);
  const float* corner = picture.data() + static_cast<std::ptrdiff_t>(top) * width + left;
  const auto x = static_cast<float>(u - left);
  const auto y = static_cast<float>(v - top);
  const auto [low, high] = std::minmax({corner[0], corner[1], corner[width], corner[width + 1]});
  if (low <= 0 || is_edge(low, high)) {
    return corner[(y < 0.5F ? 0 : width) + (x < 0.5F ? 0 : 1)];
  }
  return (1 - y) * ((1 - x) * corner[0] + x * corner[1]) +
         y * ((1 - x) * corner[width] + x * corner[width + 1]);
}

}  // namespace

SensorOptics optics_of_unit(std::uint32_t unit) {
  if (unit == 0) {
    return {};
  }
  if (unit == 1) {
    return {.fx = 590.5, .fy = 590.5, .cx = 332, .cy = 246, .k1 = -0.06, .depth_scale = 1.012};
  }
  const WhiteNoise noise(unit);
  const auto drawn = [&noise](std::size_t number, double mean, double sigma) {
    return mean + sigma * std::clamp(static_cast<double>(noise.at(0, number)), -2.0, 2.0);
  };
  const double focal = drawn(0, 585, 6);
  return {.fx = focal,
          .fy = focal,
          .cx = drawn(1, camera.cx, 8),
          .cy = drawn(2, camera.cy, 5),
          .k1 = drawn(3, -0.1, 0.04),
          .depth_scale = drawn(4, 1, 0.01),
          .depth_offset_per_m = drawn(5, 0, 0.003)};
}

Intrinsics pinhole_of(const SensorOptics& optics) {
  const int beyond = optics.k1 != 0 || optics.k2 != 0 ? beyond_picture : 0;
  return {.width = camera.width + 2 * beyond,
          .height = camera.height + 2 * beyond,
          .fx = optics.fx,
          .fy = optics.fy,
          .cx = optics.cx + beyond,
          .cy = optics.cy + beyond};
}

InverseDepth as_seen_by(const SensorOptics& optics, const InverseDepth& pinhole) {
  if (optics == SensorOptics()) {
    return pinhole;
  }
  const Intrinsics picture = pinhole_of(optics);
  InverseDepth seen;
  seen.reserve(pixels(camera));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d ray =
          undistorted(optics, {(u - optics.cx) / optics.fx, (v - optics.cy) / optics.fy});
      const double column = ray.x() * picture.fx + picture.cx;
      const double row = ray.y() * picture.fy + picture.cy;
      const bool is_inside =
          column >= 0 && row >= 0 && column < picture.width - 1 && row < picture.height - 1;
      const float truth = is_inside ? between(pinhole, picture.width, column, row) : 0;
      seen.push_back(truth > 0 ? std::max(0.0F, static_cast<float>(optics.depth_scale *
                                                                       static_cast<double>(truth) -
                                                                   optics.depth_offset_per_m))
                               : 0.0F);
    }
  }
  return seen;
}

}  // namespace octurn
