#include "simulator/sensor_unit.hpp"

#include <algorithm>
#include <cmath>

#include "simulator/camera.hpp"
#include "simulator/lens_distortion.hpp"
#include "simulator/noise_field.hpp"
#include "simulator/surface.hpp"

namespace octurn {
namespace {

/// Pixels of the pinhole picture beyond each edge: k1 of -0.18 and a principal point that is 16
/// pixels off show the corners 50 pixels further out.
constexpr int beyond_picture = 56;

/// The inverse depth between pixels: of one surface it is affine, and at an edge the nearest
/// pixel's.
float between(const InverseDepth& picture, int width, const Eigen::Vector2f& place) {
  const auto left = static_cast<int>(place.x());
  const auto top = static_cast<int>(place.y());
  const float* corner = picture.data() + static_cast<std::ptrdiff_t>(top) * width + left;
  const float x = place.x() - static_cast<float>(left);
  const float y = place.y() - static_cast<float>(top);
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

SensorView::SensorView(const SensorOptics& optics) : optics_(optics) {
  if (optics == SensorOptics()) {
    return;
  }
  const Intrinsics picture = pinhole_of(optics);
  places_.reserve(pixels(camera));
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d ray = undistorted(
          {(u - optics.cx) / optics.fx, (v - optics.cy) / optics.fy}, optics.k1, optics.k2);
      const Eigen::Vector2d place(ray.x() * picture.fx + picture.cx,
                                  ray.y() * picture.fy + picture.cy);
      places_.emplace_back(place.cast<float>());
    }
  }
}

InverseDepth SensorView::of(const InverseDepth& pinhole) const {
  if (places_.empty()) {
    return pinhole;
  }
  const Intrinsics picture = pinhole_of(optics_);
  const auto right = static_cast<float>(picture.width - 1);
  const auto bottom = static_cast<float>(picture.height - 1);
  const auto scale = static_cast<float>(optics_.depth_scale);
  const auto offset = static_cast<float>(optics_.depth_offset_per_m);
  InverseDepth seen;
  seen.reserve(places_.size());
  for (const Eigen::Vector2f& place : places_) {
    const bool is_inside =
        place.x() >= 0 && place.y() >= 0 && place.x() < right && place.y() < bottom;
    const float truth = is_inside ? between(pinhole, picture.width, place) : 0;
    seen.push_back(truth > 0 ? std::max(0.0F, scale * truth - offset) : 0.0F);
  }
  return seen;
}

}  // namespace octurn
