#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// Pixels of an image: a half-open rectangle.
struct PixelRectangle {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;
};

/// The bounding rectangle of a convex body's projection, with a margin; the whole image if the body
/// reaches behind the sensor.
/// @param corners  metres, optical frame: the body lies inside their convex hull
inline PixelRectangle seen_pixels(const Intrinsics& lens,
                                  std::span<const Eigen::Vector3d> corners) {
  constexpr double margin = 2;  // pixels, for rounding
  Eigen::Array2d min = Eigen::Array2d::Constant(std::numeric_limits<double>::max());
  Eigen::Array2d max = Eigen::Array2d::Constant(std::numeric_limits<double>::lowest());
  for (const Eigen::Vector3d& corner : corners) {
    if (!(corner.z() > nearest_z)) {
      return {.right = lens.width, .bottom = lens.height};
    }
    const Eigen::Array2d pixel = project(lens, corner).array();
    min = min.min(pixel);
    max = max.max(pixel);
  }
  const auto clamped = [](double at, int size) {
    return static_cast<int>(std::clamp(at, 0.0, static_cast<double>(size)));
  };
  return {.left = clamped(min.x() - margin, lens.width),
          .top = clamped(min.y() - margin, lens.height),
          .right = clamped(max.x() + margin, lens.width),
          .bottom = clamped(max.y() + margin, lens.height)};
}

/// The same for a box. @param box  metres, object's frame
inline PixelRectangle seen_pixels(const Snapshot& snapshot, const Box& box) {
  const Eigen::Isometry3d sensor_from_object = snapshot.object_from_sensor.inverse();
  std::array<Eigen::Vector3d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = sensor_from_object * Eigen::Vector3d(((i & 1U) != 0 ? box.max : box.min).x(),
                                                      ((i & 2U) != 0 ? box.max : box.min).y(),
                                                      ((i & 4U) != 0 ? box.max : box.min).z());
  }
  return seen_pixels(snapshot.intrinsics, corners);
}

}  // namespace octurn
