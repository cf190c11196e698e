#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <optional>

#include "depth/depth_limits.hpp"
#include "depth/pinhole.hpp"
#include "depth/seen_pixels.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

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
