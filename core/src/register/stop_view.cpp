#include "register/stop_view.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "depth/depth_limits.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

// Maximum depth range of a 5 x 5 window, metres; a larger one is a depth edge. At 0.65 m the range
// is 13 mm on a face at a grazing angle of 20 degrees, such as the top of a low object.
constexpr double max_depth_range = 0.018;
constexpr double min_ray_cosine = 0.35;  // between normal and ray

std::size_t index(int u, int v, int width) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(u);
}

}  // namespace

std::vector<double> to_inverse_depths(double depth_unit) {
  std::vector<double> inverse_depths(std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1);
  for (std::size_t depth = 1; depth < inverse_depths.size(); ++depth) {
    inverse_depths[depth] = 1 / (static_cast<double>(depth) * depth_unit);
  }
  return inverse_depths;
}

StopView::StopView(const DepthFrame& frame, const Intrinsics& intrinsics,
                   const Eigen::Isometry3d& turn_from_sensor, Box object,
                   std::shared_ptr<const std::vector<double>> inverse_depths)
    : intrinsics_(intrinsics),
      sensor_from_turn_(turn_from_sensor.inverse()),
      turn_from_sensor_(turn_from_sensor.linear()),
      eye_(turn_from_sensor.translation()),
      object_(std::move(object)),
      inverse_depths_(std::move(inverse_depths)) {
  check_size(frame, intrinsics, "register_turns");
  keep_object(frame);
}

/// Stores the rectangle of the depth image that contains the object's pixels.
void StopView::keep_object(const DepthFrame& frame) {
  std::array<Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = sensor_from_turn_ * Vector3d(((i & 1U) != 0 ? object_.max : object_.min).x(),
                                              ((i & 2U) != 0 ? object_.max : object_.min).y(),
                                              ((i & 4U) != 0 ? object_.max : object_.min).z());
  }
  window_ = find_object(
      frame, intrinsics_, seen_pixels(intrinsics_, corners),
      [&](const Vector3d& seen) { return contains(object_, turn_from_sensor_ * seen + eye_); });
  depth_.reserve(index(0, window_.height, window_.width));
  for (int v = window_.top; v < window_.top + window_.height; ++v) {
    const auto row =
        frame.depth.begin() + static_cast<std::ptrdiff_t>(index(window_.left, v, frame.width));
    depth_.insert(depth_.end(), row, row + window_.width);
  }
}

/// Returns the surface at a pixel of the rectangle, from a plane fitted to the 5 x 5 pixels around
/// it: the inverse depth of a plane is linear in the image.
std::optional<SurfacePoint> StopView::read(int u, int v) const {
  if (u < normal_reach || v < normal_reach || u >= window_.width - normal_reach ||
      v >= window_.height - normal_reach) {
    return std::nullopt;
  }
  std::uint16_t nearest = depth(u, v);
  std::uint16_t farthest = nearest;
  const std::vector<double>& inverse_depths = *inverse_depths_;
  InverseDepthSums sums;
  for (int dv = -normal_reach; dv <= normal_reach; ++dv) {
    for (int du = -normal_reach; du <= normal_reach; ++du) {
      const std::uint16_t depth_here = depth(u + du, v + dv);
      nearest = std::min(nearest, depth_here);
      farthest = std::max(farthest, depth_here);
      const double inverse = inverse_depths[depth_here];
      sums.sum += inverse;
      sums.sum_u += du * inverse;
      sums.sum_v += dv * inverse;
    }
  }
  const double nearest_of_all = nearest * intrinsics_.depth_unit;
  if (nearest_of_all <= nearest_z ||
      farthest * intrinsics_.depth_unit - nearest_of_all > max_depth_range) {
    return std::nullopt;
  }
  const Vector3d ray = to_ray(intrinsics_, window_.left + u, window_.top + v);
  const auto normal = fit_normal(sums, intrinsics_, ray, min_ray_cosine);
  if (!normal) {
    return std::nullopt;
  }
  return SurfacePoint{
      .point = turn_from_sensor_ * (ray * (InverseDepthSums::count / sums.sum)) + eye_,
      .normal = turn_from_sensor_ * *normal};
}

std::optional<SurfacePoint> StopView::look_up(const Vector3d& point) const {
  const Vector3d seen = sensor_from_turn_ * point;
  if (!(seen.z() > nearest_z)) {
    return std::nullopt;
  }
  const Eigen::Vector2d pixel = project(intrinsics_, seen);
  const double u = pixel.x() - window_.left;
  const double v = pixel.y() - window_.top;
  if (!(u > 0 && v > 0 && u < window_.width && v < window_.height)) {
    return std::nullopt;
  }
  return read(static_cast<int>(u + 0.5), static_cast<int>(v + 0.5));
}

std::vector<SurfacePoint> StopView::readings(int step) const {
  std::vector<SurfacePoint> readings;
  for (int v = normal_reach; v < window_.height - normal_reach; v += step) {
    for (int u = normal_reach; u < window_.width - normal_reach; u += step) {
      const auto reading = read(u, v);
      if (reading && contains(object_, reading->point)) {
        readings.push_back(*reading);
      }
    }
  }
  return readings;
}

}  // namespace octurn
