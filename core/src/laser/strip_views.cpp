#include "laser/strip_views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <utility>

#include "depth/back_project.hpp"
#include "depth/depth_limits.hpp"
#include "laser/draw_triangle.hpp"

namespace octurn {
namespace {

constexpr int margin = 2;            // pixels around what a view shows
constexpr int max_view_side = 4096;  // pixels of a view
constexpr double own_share = 0.49;   // of the own line at a pixel: neighbours overlap a little
constexpr float min_strip_cosine = 0.15F;  // of incidence: 81 degrees
constexpr float weight_of_line = 2.0F;     // of a surface: it outweighs one ray that passes through
constexpr double platform_slack = 0.0015;  // metres above the platform that may be the platform

/// Flags the points of a strip that lie inside the clip boxes: 1, else 0.
std::vector<char> find_inside(const LineStrip& strip, Box clip_box, const Placement* placement) {
  PointGrid grid{
      .width = static_cast<int>(strip.points.size()), .height = 1, .points = strip.points};
  if (placement == nullptr) {
    clip_box.min.z() = std::max(clip_box.min.z(), platform_slack);
  }
  clip(grid, clip_box);
  if (placement != nullptr) {
    clip(grid, *placement);
  }
  std::vector<char> inside;
  std::ranges::transform(grid.points, std::back_inserter(inside), [](const Eigen::Vector3f& point) {
    return static_cast<char>(is_point(point) ? 1 : 0);
  });
  return inside;
}

/// Draws a strip's triangles into the image of a pinhole camera.
class StripView {
 public:
  /// @param lens  focal lengths; the view's window and principal point are found here
  StripView(const LineStrip& strip, const std::vector<char>& inside,
            const Eigen::Isometry3d& sensor_from_object, const Intrinsics& lens)
      : strip_(strip), inside_(inside), lens_(lens), sensor_from_object_(sensor_from_object) {
    for (const Eigen::Vector3f& point : strip.points) {
      points_.push_back(sensor_from_object * point.cast<double>());
    }
  }

  /// Returns nothing if the strip is empty, too large, or not in front of the camera.
  std::optional<ConditionedDepth> draw() {
    if (!find_window()) {
      return std::nullopt;
    }
    observations_.resize(static_cast<std::size_t>(lens_.width) *
                         static_cast<std::size_t>(lens_.height));
    for (const auto* triangles : {&strip_.to_previous, &strip_.to_next}) {
      for (const LineStrip::Triangle& triangle : *triangles) {
        draw(triangle);
      }
    }
    return ConditionedDepth(lens_, sensor_from_object_, std::move(observations_));
  }

 private:
  ImageCorner to_corner(std::uint32_t point) const {
    const Eigen::Vector3d& p = points_[point];
    const double inverse = 1 / p.z();
    return {.u = p.x() * inverse * lens_.fx + lens_.cx,
            .v = p.y() * inverse * lens_.fy + lens_.cy,
            .inverse_depth = inverse};
  }

  /// Fits the view's size and principal point to the strip. @return false if there is no view
  bool find_window() {
    double u0 = 1e9, u1 = -1e9, v0 = 1e9, v1 = -1e9;
    for (const auto* triangles : {&strip_.to_previous, &strip_.to_next}) {
      for (const LineStrip::Triangle& triangle : *triangles) {
        for (const std::uint32_t point : triangle) {
          if (!(points_[point].z() > nearest_z)) {
            return false;
          }
          const ImageCorner at = to_corner(point);
          u0 = std::min(u0, at.u);
          u1 = std::max(u1, at.u);
          v0 = std::min(v0, at.v);
          v1 = std::max(v1, at.v);
        }
      }
    }
    if (!(u1 - u0 < max_view_side) || !(v1 - v0 < max_view_side) || u1 < u0) {
      return false;
    }
    const double left = std::floor(u0) - margin;
    const double top = std::floor(v0) - margin;
    lens_.cx -= left;
    lens_.cy -= top;
    lens_.width = static_cast<int>(u1 - left) + 1 + margin;
    lens_.height = static_cast<int>(v1 - top) + 1 + margin;
    return true;
  }

  void draw(const LineStrip::Triangle& triangle) {
    std::array<ImageCorner, 3> corners;
    std::ranges::transform(triangle, corners.begin(),
                           [this](std::uint32_t point) { return to_corner(point); });
    if (const std::optional<DepthObservation> plane = find_plane(triangle)) {
      visit_pixels(corners, lens_.width, lens_.height,
                   [&](int u, int v, const std::array<double, 3>& shares) {
                     set(u, v, triangle, shares, inverse_depth_at(corners, shares), *plane);
                   });
    }
  }

  /// The plane of a triangle; nothing at grazing incidence.
  std::optional<DepthObservation> find_plane(const LineStrip::Triangle& triangle) const {
    const Eigen::Vector3d& p = points_[triangle[0]];
    const Eigen::Vector3d side = points_[triangle[1]] - p;
    const Eigen::Vector3d normal = side.cross(points_[triangle[2]] - p);
    const double towards = -normal.dot(p);
    const double length = normal.norm();
    if (!(length > 0)) {
      return std::nullopt;
    }
    const double sign = towards < 0 ? -1 : 1;
    const auto cosine = static_cast<float>(std::abs(towards) / (length * p.norm()));
    if (cosine < min_strip_cosine) {
      return std::nullopt;
    }
    const Eigen::Vector3d unit = normal * (sign / length);
    return DepthObservation{.normal = {static_cast<float>(unit.x()), static_cast<float>(unit.y()),
                                       static_cast<float>(unit.z())},
                            .offset = static_cast<float>(-unit.dot(p)),
                            .weight = weight_of_line};
  }

  void set(int u, int v, const LineStrip::Triangle& triangle, const std::array<double, 3>& shares,
           double inverse_depth, const DepthObservation& plane) {
    double own = 0;
    bool is_inside = true;
    for (std::size_t i = 0; i < 3; ++i) {
      own += triangle[i] < strip_.own_points ? shares[i] : 0;
      is_inside &= inside_[triangle[i]] != 0;
    }
    if (own < own_share) {
      return;
    }
    DepthObservation& at =
        observations_[static_cast<std::size_t>(v) * static_cast<std::size_t>(lens_.width) +
                      static_cast<std::size_t>(u)];
    const auto z = static_cast<float>(1 / inverse_depth);
    if (at.free_space_depth > 0 && at.free_space_depth <= z) {
      return;
    }
    at = plane;
    at.weight = is_inside ? plane.weight : 0.0F;
    at.free_space_depth = z;
  }

  const LineStrip& strip_;
  const std::vector<char>& inside_;
  Intrinsics lens_;
  Eigen::Isometry3d sensor_from_object_;
  std::vector<Eigen::Vector3d> points_ = {};  // optical frame
  std::vector<DepthObservation> observations_ = {};
};

/// The pose of a laser's view: Z points to the mean of its own line.
std::optional<Eigen::Isometry3d> laser_from_object(const LineStrip& strip) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < strip.own_points; ++i) {
    if (is_point(strip.points[i])) {
      middle += strip.points[i].cast<double>();
      ++count;
    }
  }
  if (count == 0) {
    return std::nullopt;
  }
  const Eigen::Vector3d towards = middle / count - *strip.source;
  if (towards.norm() < nearest_z) {
    return std::nullopt;
  }
  const Eigen::Vector3d z = towards.normalized();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitZ().cross(z);
  if (x.norm() < 0.05) {  // a laser right above the object
    return std::nullopt;
  }
  Eigen::Isometry3d object_from_laser = Eigen::Isometry3d::Identity();
  object_from_laser.linear().col(0) = x.normalized();
  object_from_laser.linear().col(1) = z.cross(x.normalized());
  object_from_laser.linear().col(2) = z;
  object_from_laser.translation() = *strip.source;
  return object_from_laser.inverse();
}

}  // namespace

std::vector<ConditionedDepth> strip_views(const Snapshot& snapshot, const Box& clip,
                                          const Placement* placement) {
  std::vector<ConditionedDepth> views;
  const auto add = [&](std::optional<ConditionedDepth> view) {
    if (view) {
      views.push_back(*std::move(view));
    }
  };
  for (const LineStrip& strip : snapshot.strips) {
    const std::vector<char> inside = find_inside(strip, clip, placement);
    add(StripView(strip, inside, snapshot.object_from_sensor.inverse(), snapshot.intrinsics)
            .draw());
    if (strip.source) {
      if (const auto pose = laser_from_object(strip)) {
        add(StripView(strip, inside, *pose, snapshot.intrinsics).draw());
      }
    }
  }
  return views;
}

}  // namespace octurn
