#include "register/stop_view.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "depth/depth_limits.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

// Metres of depth among the 5 x 5 pixels: more is an edge. At 0.65 m a face that is seen under 20
// degrees falls by 13 mm over them, and the top of a low object is such a face.
constexpr double max_step = 0.018;
constexpr double min_cosine = 0.35;    // between normal and ray
constexpr int block = 4;               // pixels along a side, of what is known of free space
constexpr double free_margin = 0.006;  // metres that a surface must be behind a free point
constexpr int half_block = block * block / 2;

std::size_t index(int u, int v, int width) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(u);
}

int blocks(int pixels) { return (pixels + block - 1) / block; }

}  // namespace

StopView::StopView(const DepthFrame& frame, const Intrinsics& intrinsics,
                   const Eigen::Isometry3d& turn_from_sensor, Box object)
    : intrinsics_(intrinsics),
      sensor_from_turn_(turn_from_sensor.inverse()),
      turn_from_sensor_(turn_from_sensor.linear()),
      eye_(turn_from_sensor.translation()),
      object_(std::move(object)) {
  check_size(frame, intrinsics, "register_turns");
  keep_object(frame);
  find_free_depths(frame);
}

/// Keeps the rectangle of the pixels that are the object's.
void StopView::keep_object(const DepthFrame& frame) {
  window_ = find_object(frame, intrinsics_, [&](const Vector3d& seen) {
    return contains(object_, turn_from_sensor_ * seen + eye_);
  });
  depth_.reserve(index(0, window_.height, window_.width));
  for (int v = window_.top; v < window_.top + window_.height; ++v) {
    const auto row =
        frame.depth.begin() + static_cast<std::ptrdiff_t>(index(window_.left, v, frame.width));
    depth_.insert(depth_.end(), row, row + window_.width);
  }
}

void StopView::find_free_depths(const DepthFrame& frame) {
  for (int v = 0; v < frame.height; v += block) {
    for (int u = 0; u < frame.width; u += block) {
      std::uint16_t nearest = std::numeric_limits<std::uint16_t>::max();
      int readings = 0;
      for (int row = v; row < std::min(v + block, frame.height); ++row) {
        for (int column = u; column < std::min(u + block, frame.width); ++column) {
          const std::uint16_t depth = frame.depth[index(column, row, frame.width)];
          if (depth > 0) {
            nearest = std::min(nearest, depth);
            ++readings;
          }
        }
      }
      free_.push_back(readings >= half_block ? nearest : std::uint16_t{0});
    }
  }
}

/// The surface at a pixel of the rectangle, by the plane through its neighbours: the inverse depth
/// of a plane is linear in the image.
std::optional<SurfacePoint> StopView::read(int u, int v) const {
  if (u < normal_reach || v < normal_reach || u >= window_.width - normal_reach ||
      v >= window_.height - normal_reach) {
    return std::nullopt;
  }
  double nearest = depth(u, v);
  double farthest = nearest;
  InverseDepthSums sums;
  for (int dv = -normal_reach; dv <= normal_reach; ++dv) {
    for (int du = -normal_reach; du <= normal_reach; ++du) {
      const double z = depth(u + du, v + dv);
      if (z <= nearest_z) {
        return std::nullopt;
      }
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
      const double inverse = 1 / z;
      sums.sum += inverse;
      sums.sum_u += du * inverse;
      sums.sum_v += dv * inverse;
    }
  }
  if (farthest - nearest > max_step) {
    return std::nullopt;
  }
  const Vector3d ray = to_ray(intrinsics_, window_.left + u, window_.top + v);
  const auto normal = fit_normal(sums, intrinsics_, ray, min_cosine);
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

bool StopView::saw_through(const Vector3d& point) const {
  const Vector3d seen = sensor_from_turn_ * point;
  if (!(seen.z() > nearest_z)) {
    return false;
  }
  const Eigen::Vector2d pixel = project(intrinsics_, seen);
  const double u = pixel.x() + 0.5;
  const double v = pixel.y() + 0.5;
  if (!(u >= 0 && v >= 0 && u < intrinsics_.width && v < intrinsics_.height)) {
    return false;
  }
  const std::uint16_t free = free_[index(static_cast<int>(u) / block, static_cast<int>(v) / block,
                                         blocks(intrinsics_.width))];
  return free > 0 && free * intrinsics_.depth_unit > seen.z() + free_margin;
}

}  // namespace octurn
