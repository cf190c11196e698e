#include "register/stop_view.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "depth/depth_limits.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr int reach = 2;               // pixels: a normal is fitted to 5 x 5 of them
constexpr double max_step = 0.01;      // metres of depth among these: more is an edge
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
  find_object(frame);
  find_free_depths(frame);
}

Vector3d StopView::to_ray(int u, int v) const {
  return {(u - intrinsics_.cx) / intrinsics_.fx, (v - intrinsics_.cy) / intrinsics_.fy, 1};
}

/// Keeps the rectangle of the pixels that are the object's.
void StopView::find_object(const DepthFrame& frame) {
  int right = -1;
  int bottom = -1;
  int left = frame.width;
  int top = frame.height;
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const double z = frame.depth[index(u, v, frame.width)] * intrinsics_.depth_unit;
      if (z <= nearest_z) {
        continue;
      }
      const Vector3d point = turn_from_sensor_ * (to_ray(u, v) * z) + eye_;
      if ((point.array() >= object_.min.array()).all() &&
          (point.array() <= object_.max.array()).all()) {
        ++pixels_;
        left = std::min(left, u);
        right = std::max(right, u);
        top = std::min(top, v);
        bottom = v;
      }
    }
  }
  if (pixels_ == 0) {
    return;
  }
  left_ = std::max(left - reach, 0);
  top_ = std::max(top - reach, 0);
  width_ = std::min(right + reach + 1, frame.width) - left_;
  height_ = std::min(bottom + reach + 1, frame.height) - top_;
  depth_.reserve(index(0, height_, width_));
  for (int v = top_; v < top_ + height_; ++v) {
    const auto row =
        frame.depth.begin() + static_cast<std::ptrdiff_t>(index(left_, v, frame.width));
    depth_.insert(depth_.end(), row, row + width_);
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
  if (u < reach || v < reach || u >= width_ - reach || v >= height_ - reach) {
    return std::nullopt;
  }
  double nearest = depth(u, v);
  double farthest = nearest;
  double sum = 0;
  double sum_u = 0;
  double sum_v = 0;
  for (int dv = -reach; dv <= reach; ++dv) {
    for (int du = -reach; du <= reach; ++du) {
      const double z = depth(u + du, v + dv);
      if (z <= nearest_z) {
        return std::nullopt;
      }
      nearest = std::min(nearest, z);
      farthest = std::max(farthest, z);
      sum += 1 / z;
      sum_u += du / z;
      sum_v += dv / z;
    }
  }
  if (farthest - nearest > max_step) {
    return std::nullopt;
  }
  constexpr double count = (2 * reach + 1) * (2 * reach + 1);
  constexpr double squares = 2.0 * (1 + 4) * (2 * reach + 1);  // of du, over the neighbours
  const Vector3d ray = to_ray(left_ + u, top_ + v);
  const double slope_x = sum_u / squares * intrinsics_.fx;
  const double slope_y = sum_v / squares * intrinsics_.fy;
  const Vector3d away(slope_x, slope_y, sum / count - slope_x * ray.x() - slope_y * ray.y());
  const Vector3d normal = -away.normalized();
  if (!(-normal.dot(ray) > min_cosine * ray.norm())) {
    return std::nullopt;
  }
  return SurfacePoint{.point = turn_from_sensor_ * (ray * (count / sum)) + eye_,
                      .normal = turn_from_sensor_ * normal};
}

std::optional<SurfacePoint> StopView::look_up(const Vector3d& point) const {
  const Vector3d seen = sensor_from_turn_ * point;
  if (!(seen.z() > nearest_z)) {
    return std::nullopt;
  }
  const double u = seen.x() / seen.z() * intrinsics_.fx + intrinsics_.cx - left_;
  const double v = seen.y() / seen.z() * intrinsics_.fy + intrinsics_.cy - top_;
  if (!(u > 0 && v > 0 && u < width_ && v < height_)) {
    return std::nullopt;
  }
  return read(static_cast<int>(std::lround(u)), static_cast<int>(std::lround(v)));
}

std::vector<SurfacePoint> StopView::readings(int step) const {
  std::vector<SurfacePoint> readings;
  for (int v = reach; v < height_ - reach; v += step) {
    for (int u = reach; u < width_ - reach; u += step) {
      const auto reading = read(u, v);
      if (reading && (reading->point.array() >= object_.min.array()).all() &&
          (reading->point.array() <= object_.max.array()).all()) {
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
  const double u = seen.x() / seen.z() * intrinsics_.fx + intrinsics_.cx + 0.5;
  const double v = seen.y() / seen.z() * intrinsics_.fy + intrinsics_.cy + 0.5;
  if (!(u >= 0 && v >= 0 && u < intrinsics_.width && v < intrinsics_.height)) {
    return false;
  }
  const std::uint16_t free = free_[index(static_cast<int>(u) / block, static_cast<int>(v) / block,
                                         blocks(intrinsics_.width))];
  return free > 0 && free * intrinsics_.depth_unit > seen.z() + free_margin;
}

}  // namespace octurn
