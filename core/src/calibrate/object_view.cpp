#include "calibrate/object_view.hpp"

#include <algorithm>
#include <array>

#include "depth/depth_limits.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double max_mask_radius = 0.2;
// Surfaces at a grazing angle determine the axis's position best: at 0.65 m the depth of one at 75
// degrees changes by 17 mm over 5 pixels, and an object of 3 cm shows little else.
constexpr double max_depth_range = 0.022;  // metres: a larger range of depth is an edge
constexpr double min_cosine = 0.25;        // between normal and ray

/// The corners of a box around what a mask contains, metres, optical frame.
std::array<Vector3d, 8> to_corners(const ObjectView::Mask& mask) {
  const Vector3d& up = mask.plane.normal;
  const Vector3d foot = mask.axis_point - mask.plane.height(mask.axis_point) * up;
  const Vector3d right = max_mask_radius * up.unitOrthogonal();
  const Vector3d ahead = up.cross(right);
  std::array<Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = foot + ((i & 1U) != 0 ? max_object_height : mask.min_height) * up +
                 ((i & 2U) != 0 ? 1 : -1) * right + ((i & 4U) != 0 ? 1 : -1) * ahead;
  }
  return corners;
}

}  // namespace

bool ObjectView::Mask::contains(const Vector3d& point) const {
  const double height = plane.height(point);
  const Vector3d across = point - axis_point - height * plane.normal;
  return height > min_height && height < max_object_height &&
         across.squaredNorm() < max_mask_radius * max_mask_radius;
}

ObjectView::ObjectView(const DepthFrame& frame, const Intrinsics& intrinsics, const Mask& mask)
    : camera_{.pinhole = intrinsics}, mask_(mask) {
  check_size(frame, intrinsics, "calibrate");
  window_ = find_object(frame, intrinsics, seen_pixels(intrinsics, to_corners(mask)),
                        [&](const Vector3d& point) { return mask.contains(point); });
  inverse_depth_.reserve(static_cast<std::size_t>(window_.width) *
                         static_cast<std::size_t>(window_.height));
  for (int v = window_.top; v < window_.top + window_.height; ++v) {
    for (int u = window_.left; u < window_.left + window_.width; ++u) {
      const double z =
          frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                      static_cast<std::size_t>(u)] *
          intrinsics.depth_unit;
      inverse_depth_.push_back(z > nearest_z ? static_cast<float>(1 / z) : 0.0F);
    }
  }
}

/// The reading of a pixel of the rectangle, with the normal of the plane through its neighbours:
/// the inverse depth of a plane is linear in the image.
std::optional<SurfaceReading> ObjectView::read(int u, int v) const {
  if (u < normal_reach || v < normal_reach || u >= window_.width - normal_reach ||
      v >= window_.height - normal_reach) {
    return std::nullopt;
  }
  float nearest = at(u, v);
  float farthest = nearest;
  InverseDepthSums sums;
  static_assert(normal_reach == 2);  // five values in a row
  for (int dv = -normal_reach; dv <= normal_reach; ++dv) {
    // Half of a calibration's time is spent here: the sums of a row do not wait for each other.
    const float* row = &inverse_depth_[index(u - normal_reach, v + dv)];
    nearest = std::max(std::max(nearest, row[2]),
                       std::max(std::max(row[0], row[4]), std::max(row[1], row[3])));
    farthest = std::min(std::min(farthest, row[2]),
                        std::min(std::min(row[0], row[4]), std::min(row[1], row[3])));
    const auto value = [&](int i) { return static_cast<double>(row[i]); };
    const double sum = (value(0) + value(4)) + (value(1) + value(3)) + value(2);
    sums.sum += sum;
    sums.sum_u += 2 * (value(4) - value(0)) + (value(3) - value(1));
    sums.sum_v += dv * sum;
  }
  if (!(farthest > 0) ||
      1 / static_cast<double>(farthest) - 1 / static_cast<double>(nearest) > max_depth_range) {
    return std::nullopt;
  }
  const Vector3d ray = camera_.ray(window_.left + u, window_.top + v);
  const auto normal = fit_normal(sums, camera_.pinhole, ray, min_cosine);
  if (!normal) {
    return std::nullopt;
  }
  return SurfaceReading{.point = ray / static_cast<double>(at(u, v)), .normal = *normal};
}

std::optional<SurfaceReading> ObjectView::look_up(const Vector3d& point) const {
  if (!(point.z() > nearest_z)) {
    return std::nullopt;
  }
  const Eigen::Vector2d pixel = camera_.pixel(point);
  const double u = pixel.x() - window_.left;
  const double v = pixel.y() - window_.top;
  if (!(u > 0 && v > 0 && u < window_.width && v < window_.height)) {
    return std::nullopt;
  }
  return read(static_cast<int>(u + 0.5), static_cast<int>(v + 0.5));
}

void ObjectView::set_camera(const DistortedCamera& camera, const Mask& mask) {
  camera_ = camera;
  mask_ = mask;
}

std::vector<SurfaceReading> ObjectView::readings(int step) const {
  std::vector<SurfaceReading> readings;
  for (int v = normal_reach; v < window_.height - normal_reach; v += step) {
    for (int u = normal_reach; u < window_.width - normal_reach; u += step) {
      const auto reading = read(u, v);
      if (reading && mask_.contains(reading->point)) {
        readings.push_back(*reading);
      }
    }
  }
  return readings;
}

ObjectView::Mask make_mask(const Eigen::Isometry3d& platform_from_sensor) {
  const Eigen::Isometry3d sensor_from_platform = platform_from_sensor.inverse();
  const Vector3d normal = sensor_from_platform.linear() * Vector3d::UnitZ();
  return {.plane = {.normal = normal, .offset = normal.dot(sensor_from_platform.translation())},
          .axis_point = sensor_from_platform.translation()};
}

}  // namespace octurn
