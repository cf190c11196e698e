#include "capture/platform_swing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octurn/units.hpp"
#include "sensor/pixel_ray.hpp"

namespace octurn {
namespace {

constexpr int pixel_step = 2;        // in both directions: thousands of pixels are enough
constexpr int gradient_reach = 3;    // pixels: beyond a Kinect's steps of depth
constexpr double max_step = 0.008;   // metres over `gradient_reach` on one surface
constexpr double max_change = 0.01;  // metres; an edge that passed a pixel changes it by more
constexpr std::size_t min_pixels = 100;
constexpr double still = radians_from_degrees(0.15);  // 0.25 mm, 10 cm from the axis
// Of 36 pairs of frames of a standing platform, with a Kinect's noise, the most was 2.5.
constexpr double more_than_noise = 5;  // standard errors of the fit

/// A pixel of the object, and how its depth changes as the platform turns.
struct Slope {
  std::size_t pixel = 0;
  double depth_by_angle = 0;  // metres a radian
};

class Slopes {
 public:
  Slopes(const PlatformLook& look, const DepthFrame& frame)
      : look_(look), frame_(frame), sensor_from_platform_(look.platform_from_sensor.inverse()) {}

  std::vector<Slope> all() const;

 private:
  std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(frame_.width) +
           static_cast<std::size_t>(u);
  }
  double depth(int u, int v) const {
    return frame_.depth[index(u, v)] * look_.intrinsics.depth_unit;
  }
  void add(int u, int v, std::vector<Slope>& slopes) const;

  const PlatformLook& look_;
  const DepthFrame& frame_;
  Eigen::Isometry3d sensor_from_platform_;
};

std::vector<Slope> Slopes::all() const {
  std::vector<Slope> slopes;
  for (int v = gradient_reach; v < frame_.height - gradient_reach; v += pixel_step) {
    for (int u = gradient_reach; u < frame_.width - gradient_reach; u += pixel_step) {
      add(u, v, slopes);
    }
  }
  return slopes;
}

void Slopes::add(int u, int v, std::vector<Slope>& slopes) const {
  const Intrinsics& lens = look_.intrinsics;
  const double z = depth(u, v);
  const Eigen::Vector3d point = z * pixel_ray(lens, u, v);
  if (z == 0 || !contains(look_.clip, look_.platform_from_sensor * point)) {
    return;
  }
  const double left = depth(u - gradient_reach, v);
  const double right = depth(u + gradient_reach, v);
  const double above = depth(u, v - gradient_reach);
  const double below = depth(u, v + gradient_reach);
  for (const double other : {left, right, above, below}) {
    if (std::abs(other - z) > max_step) {  // another surface, or no reading
      return;
    }
  }
  // The surface's point moves by the cross product of axis and arm, and takes its depth along.
  const Eigen::Vector3d axis = sensor_from_platform_.linear().col(2);
  const Eigen::Vector3d moved = axis.cross(point - sensor_from_platform_.translation());
  const double moved_u = lens.fx * (moved.x() - point.x() / z * moved.z()) / z;
  const double moved_v = lens.fy * (moved.y() - point.y() / z * moved.z()) / z;
  slopes.push_back(
      {.pixel = index(u, v),
       .depth_by_angle = moved.z() - ((right - left) * moved_u + (below - above) * moved_v) /
                                         (2 * gradient_reach)});
}

/// Whether the second frame is turned from the first.
bool is_turned(const std::vector<Slope>& slopes, const DepthFrame& from, const DepthFrame& to,
               double depth_unit) {
  std::size_t count = 0;
  double changes = 0;  // sums of squares and products
  double slopes2 = 0;
  double products = 0;
  for (const Slope& slope : slopes) {
    const std::uint16_t before = from.depth[slope.pixel];
    const std::uint16_t after = to.depth[slope.pixel];
    const double change = (static_cast<double>(after) - before) * depth_unit;
    if (before != 0 && after != 0 && std::abs(change) <= max_change) {
      ++count;
      changes += change * change;
      slopes2 += slope.depth_by_angle * slope.depth_by_angle;
      products += slope.depth_by_angle * change;
    }
  }
  if (count < min_pixels || slopes2 == 0) {
    return false;
  }
  const double angle = products / slopes2;
  const double noise2 = (changes - angle * products) / static_cast<double>(count);
  return std::abs(angle) > still && std::abs(angle) > more_than_noise * std::sqrt(noise2 / slopes2);
}

}  // namespace

bool is_swinging(const PlatformLook& look, std::span<const DepthFrame> frames) {
  const DepthFrame mean = merge_frames(frames, DepthFilter::average_discard);
  const std::vector<Slope> slopes = Slopes(look, mean).all();
  // Of all pairs with the first, as the last may come after a whole swing.
  return std::ranges::any_of(frames.subspan(1), [&](const DepthFrame& frame) {
    return is_turned(slopes, frames.front(), frame, look.intrinsics.depth_unit);
  });
}

void Settling::stood_after(int frames) {
  // A little less each time, so that it follows a platform that was relieved of its weight.
  frames_ = std::min(std::max(frames, frames_ - 1), max_settling_frames);
}

}  // namespace octurn
