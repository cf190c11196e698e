#include "depth/back_project.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "depth/depth_limits.hpp"

namespace octurn {

PointGrid world_points(const Snapshot& snapshot) {
  return world_points(snapshot, {.right = snapshot.frame.width, .bottom = snapshot.frame.height});
}

PointGrid world_points(const Snapshot& snapshot, const PixelRectangle& pixels) {
  const DepthFrame& frame = snapshot.frame;
  const Intrinsics& intrinsics = snapshot.intrinsics;
  check_size(frame, intrinsics, "world_points");

  // point = depth * (column_ray[u] + row_ray) + centre: a sample's ray is linear in u and in v.
  // Written out by component: a matrix library may fuse products on one processor and not on
  // another.
  const Eigen::Matrix3f rotation = snapshot.object_from_sensor.linear().cast<float>();
  const Eigen::Vector3f centre = snapshot.object_from_sensor.translation().cast<float>();
  const auto unit = static_cast<float>(intrinsics.depth_unit);
  PointGrid grid{
      .width = pixels.right - pixels.left, .height = pixels.bottom - pixels.top, .points = {}};
  std::vector<Eigen::Vector3f> column_rays(static_cast<std::size_t>(grid.width));
  for (int column = 0; column < grid.width; ++column) {
    const auto x = static_cast<float>((pixels.left + column - intrinsics.cx) / intrinsics.fx);
    for (int axis = 0; axis < 3; ++axis) {
      column_rays[static_cast<std::size_t>(column)][axis] = unit * (rotation(axis, 0) * x);
    }
  }

  grid.points.resize(column_rays.size() * static_cast<std::size_t>(grid.height));
  auto point = grid.points.begin();
  for (int v = pixels.top; v < pixels.bottom; ++v) {
    auto depth =
        frame.depth.begin() + static_cast<std::ptrdiff_t>(v) * intrinsics.width + pixels.left;
    const auto y = static_cast<float>((v - intrinsics.cy) / intrinsics.fy);
    std::array<float, 3> row_ray{};
    for (int axis = 0; axis < 3; ++axis) {
      row_ray[static_cast<std::size_t>(axis)] = unit * (rotation(axis, 1) * y + rotation(axis, 2));
    }
    for (const Eigen::Vector3f& column_ray : column_rays) {
      if (*depth == 0) {
        *point = no_point;
      } else {
        const auto value = static_cast<float>(*depth);
        *point = {value * (column_ray.x() + row_ray[0]) + centre.x(),
                  value * (column_ray.y() + row_ray[1]) + centre.y(),
                  value * (column_ray.z() + row_ray[2]) + centre.z()};
      }
      ++depth;
      ++point;
    }
  }
  return grid;
}

void clip(PointGrid& grid, const Placement& placement) {
  constexpr double platform_slack = 0.0025;  // metres above the platform that may be the platform
  constexpr float max_lift = 0.005F;         // metres
  const Eigen::Isometry3d platform_from_object = placement.object_from_platform.inverse();
  const Eigen::Matrix3f rotation = platform_from_object.linear().cast<float>();
  const Eigen::Vector3f shift = platform_from_object.translation().cast<float>();
  Eigen::Array3f min = placement.clip.min.cast<float>();
  min.z() = std::max(min.z(), static_cast<float>(platform_slack));
  const Eigen::Array3f max = placement.clip.max.cast<float>();
  for (Eigen::Vector3f& point : grid.points) {
    Eigen::Array3f own;
    for (int axis = 0; axis < 3; ++axis) {  // written out, as above
      own[axis] = rotation(axis, 0) * point.x() + rotation(axis, 1) * point.y() +
                  rotation(axis, 2) * point.z() + shift[axis];
    }
    if (!((own >= min).all() && (own <= max).all())) {
      point = no_point;
    } else if (point.z() < 0 && point.z() > -max_lift) {
      point.z() = 0;
    }
  }
}

void clip(PointGrid& grid, const Box& box) {
  const Eigen::Array3f min = box.min.cast<float>();
  const Eigen::Array3f max = box.max.cast<float>();
  for (Eigen::Vector3f& point : grid.points) {
    // Written so that a point with any NaN coordinate is dropped, too.
    if (!((point.array() >= min).all() && (point.array() <= max).all())) {
      point = no_point;
    }
  }
}

}  // namespace octurn
