#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
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

/// Half side of the window for fitting a normal, pixels: 5 x 5.
inline constexpr int normal_reach = 2;

/// The rectangle of a depth image around an object, with the neighbours that its normals need.
struct ObjectWindow {
  int left = 0;
  int top = 0;
  int width = 0;  // 0: no pixel is the object's
  int height = 0;
  int pixels = 0;  // number of pixels that show the object
};

/// Finds the rectangle around an object.
/// @param within     the pixels that can see it
/// @param is_object  whether a point (metres, optical frame) is the object's
template <typename IsObject>
ObjectWindow find_object(const DepthFrame& frame, const Intrinsics& intrinsics,
                         const PixelRectangle& within, const IsObject& is_object) {
  int left = frame.width;
  int right = -1;
  int top = frame.height;
  int bottom = -1;
  int pixels = 0;
  for (int v = within.top; v < within.bottom; ++v) {
    for (int u = within.left; u < within.right; ++u) {
      const std::size_t pixel =
          static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
          static_cast<std::size_t>(u);
      const double z = frame.depth[pixel] * intrinsics.depth_unit;
      if (z > nearest_z && is_object(to_ray(intrinsics, u, v) * z)) {
        ++pixels;
        left = std::min(left, u);
        right = std::max(right, u);
        top = std::min(top, v);
        bottom = v;
      }
    }
  }
  if (pixels == 0) {
    return {};
  }
  left = std::max(left - normal_reach, 0);
  top = std::max(top - normal_reach, 0);
  return {.left = left,
          .top = top,
          .width = std::min(right + normal_reach + 1, frame.width) - left,
          .height = std::min(bottom + normal_reach + 1, frame.height) - top,
          .pixels = pixels};
}

/// Moments of a 5 x 5 window: sums of inverse depth, 1/m, and of inverse depth times the pixels'
/// distances from the middle along u and v.
struct InverseDepthSums {
  static constexpr double count = (2 * normal_reach + 1) * (2 * normal_reach + 1);

  double sum = 0;
  double sum_u = 0;
  double sum_v = 0;
};

/// The normal of the least-squares plane through 5 x 5 pixels: the inverse depth of a plane is
/// linear in the image.
/// @param ray  of the middle, z = 1
/// @param min_cosine  of incidence: a surface that is seen at a flatter angle is refused
/// @return of length one, towards the sensor
inline std::optional<Eigen::Vector3d> fit_normal(const InverseDepthSums& sums,
                                                 const Intrinsics& intrinsics,
                                                 const Eigen::Vector3d& ray, double min_cosine) {
  constexpr double squares = 2.0 * (1 + 4) * (2 * normal_reach + 1);  // sum of du^2 over the window
  const double slope_x = sums.sum_u / squares * intrinsics.fx;
  const double slope_y = sums.sum_v / squares * intrinsics.fy;
  const Eigen::Vector3d away(
      slope_x, slope_y, sums.sum / InverseDepthSums::count - slope_x * ray.x() - slope_y * ray.y());
  const Eigen::Vector3d normal = -away.normalized();
  if (!(-normal.dot(ray) > min_cosine * ray.norm())) {
    return std::nullopt;
  }
  return normal;
}

}  // namespace octurn
