#include "calibrate/object_view.hpp"

#include <algorithm>
#include <cmath>

#include "depth/depth_limits.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double min_height = 0.004;  // metres above the platform, whose noise is below
constexpr double max_height = 0.4;
constexpr double max_radius = 0.2;
constexpr int reach = 2;  // pixels: a normal is fitted to 5 x 5 of them
// Surfaces that are seen from the side tell how far off the axis is: at 0.65 m one of 75 degrees
// falls by 17 mm over 5 pixels, and one of 3 cm has little else.
constexpr double max_step = 0.022;   // metres of depth among these: more is an edge
constexpr double min_cosine = 0.25;  // between normal and ray

Vector3d to_ray(const Intrinsics& intrinsics, int u, int v) {
  return {(u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy, 1};
}

}  // namespace

bool ObjectView::Mask::contains(const Vector3d& point) const {
  const double height = plane.height(point);
  const Vector3d across = point - axis_point - height * plane.normal;
  return height > min_height && height < max_height &&
         across.squaredNorm() < max_radius * max_radius;
}

ObjectView::ObjectView(const DepthFrame& frame, const Intrinsics& intrinsics, const Mask& mask)
    : intrinsics_(intrinsics), mask_(mask) {
  check_size(frame, intrinsics, "calibrate");
  const auto depth = [&](int u, int v) {
    return frame.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                       static_cast<std::size_t>(u)] *
           intrinsics.depth_unit;
  };
  int right = -1;
  int bottom = -1;
  left_ = frame.width;
  top_ = frame.height;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const double z = depth(u, v);
      if (z > nearest_z && mask.contains(to_ray(intrinsics, u, v) * z)) {
        ++pixels_;
        left_ = std::min(left_, u);
        right = std::max(right, u);
        top_ = std::min(top_, v);
        bottom = v;
      }
    }
  }
  if (pixels_ == 0) {
    return;
  }
  left_ = std::max(left_ - reach, 0);
  top_ = std::max(top_ - reach, 0);
  width_ = std::min(right + reach + 1, frame.width) - left_;
  height_ = std::min(bottom + reach + 1, frame.height) - top_;
  inverse_depth_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (int v = top_; v < top_ + height_; ++v) {
    for (int u = left_; u < left_ + width_; ++u) {
      const double z = depth(u, v);
      inverse_depth_.push_back(z > nearest_z ? static_cast<float>(1 / z) : 0.0F);
    }
  }
}

/// The reading of a pixel of the rectangle, with the normal of the plane through its neighbours:
/// the inverse depth of a plane is linear in the image.
std::optional<SurfaceReading> ObjectView::read(int u, int v) const {
  if (u < reach || v < reach || u >= width_ - reach || v >= height_ - reach) {
    return std::nullopt;
  }
  float nearest = at(u, v);
  float farthest = nearest;
  double sum = 0;
  double sum_u = 0;
  double sum_v = 0;
  for (int dv = -reach; dv <= reach; ++dv) {
    for (int du = -reach; du <= reach; ++du) {
      const float value = at(u + du, v + dv);
      nearest = std::max(nearest, value);
      farthest = std::min(farthest, value);
      sum += static_cast<double>(value);
      sum_u += du * static_cast<double>(value);
      sum_v += dv * static_cast<double>(value);
    }
  }
  if (!(farthest > 0) ||
      1 / static_cast<double>(farthest) - 1 / static_cast<double>(nearest) > max_step) {
    return std::nullopt;
  }
  constexpr double count = (2 * reach + 1) * (2 * reach + 1);
  constexpr double squares = 2.0 * (1 + 4) * (2 * reach + 1);  // of du, over the neighbours
  const Vector3d ray = to_ray(intrinsics_, left_ + u, top_ + v);
  const double slope_x = sum_u / squares * intrinsics_.fx;
  const double slope_y = sum_v / squares * intrinsics_.fy;
  const Vector3d away(slope_x, slope_y, sum / count - slope_x * ray.x() - slope_y * ray.y());
  const Vector3d normal = -away.normalized();
  if (!(-normal.dot(ray) > min_cosine * ray.norm())) {
    return std::nullopt;
  }
  return SurfaceReading{.point = ray / static_cast<double>(at(u, v)), .normal = normal};
}

std::optional<SurfaceReading> ObjectView::look_up(const Vector3d& point) const {
  if (!(point.z() > nearest_z)) {
    return std::nullopt;
  }
  const double u = point.x() / point.z() * intrinsics_.fx + intrinsics_.cx - left_;
  const double v = point.y() / point.z() * intrinsics_.fy + intrinsics_.cy - top_;
  if (!(u > 0 && v > 0 && u < width_ && v < height_)) {
    return std::nullopt;
  }
  return read(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
}

std::vector<SurfaceReading> ObjectView::readings(int step) const {
  std::vector<SurfaceReading> readings;
  for (int v = reach; v < height_ - reach; v += step) {
    for (int u = reach; u < width_ - reach; u += step) {
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
