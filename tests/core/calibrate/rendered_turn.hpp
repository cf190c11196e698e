#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "core/tsdf/rendered.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/units.hpp"

namespace octurn {

/// A sensor 0.62 m from the axis, 0.36 m above the platform, looking 25 degrees down.
inline Eigen::Isometry3d true_platform_from_sensor() {
  Eigen::Matrix3d upright;  // optical X right, Y down, Z forward, in the platform's axes
  upright << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(radians_from_degrees(-25), Eigen::Vector3d::UnitX()) * upright;
  pose.translation() = Eigen::Vector3d(0, -0.62, 0.36);
  return pose;
}

/// The true pose with an error: the platform's origin shifted by `shift` metres, and a rotation
/// about that origin.
inline Eigen::Isometry3d wrong_pose(const Eigen::Vector3d& shift, const Eigen::Vector3d& axis,
                                    double angle_deg) {
  return Eigen::Translation3d(shift) *
         Eigen::AngleAxisd(radians_from_degrees(angle_deg), axis.normalized()) *
         true_platform_from_sensor();
}

inline Shape moved(const Shape& shape, const Eigen::Vector3d& by) {
  return [=](const Eigen::Vector3d& p) { return shape(p - by); };
}

inline Shape joined(const Shape& a, const Shape& b) {
  return [=](const Eigen::Vector3d& p) { return std::min(a(p), b(p)); };
}

/// An asymmetric figure some 12 cm tall, different from each side.
inline Shape figure() {
  return joined(block({0.07, 0.045, 0.06}),
                joined(ball({0.02, 0.01, 0.085}, 0.035), ball({-0.03, -0.015, 0.06}, 0.025)));
}

/// Renders the depth of an object turned by `angle` on a disc of 30 cm. The noise is uniform in
/// disparity, as a Kinect's is, with a deviation of 0.3 steps.
/// @param object       within 20 cm of a point 6 cm above the disc's centre: rays that miss this
///                     bounding sphere are not traced
/// @param disc_normal  in the frame that turns
inline DepthFrame rendered_frame(const Shape& object, double angle, std::mt19937& random,
                                 const Eigen::Vector3d& disc_normal = Eigen::Vector3d::UnitZ()) {
  constexpr double steps_per_inverse_metre = 345.489;  // of a Kinect v1's disparity
  constexpr double noise = 0.5;  // steps, half the uniform distribution's width
  const Intrinsics lens;
  const Eigen::Isometry3d object_from_sensor =
      Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()) * true_platform_from_sensor();
  const Eigen::Vector3d origin = object_from_sensor.translation();
  const Eigen::Vector3d to_middle = Eigen::Vector3d(0, 0, 0.06) - origin;
  const double past_ball = to_middle.squaredNorm() - 0.2 * 0.2;
  DepthFrame frame{.width = lens.width, .height = lens.height, .depth = {}};
  frame.depth.reserve(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height));
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector3d through((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
      const DepthRay ray{.origin = origin, .direction = object_from_sensor.linear() * through};
      const double to_disc = -disc_normal.dot(origin) / disc_normal.dot(ray.direction);
      const bool on_disc =
          to_disc > 0 && (origin + to_disc * ray.direction).head<2>().norm() < 0.15;
      const double end = on_disc ? to_disc : 1.0;
      const double along = to_middle.dot(ray.direction);
      const bool may_meet = along * along > past_ball * ray.direction.squaredNorm();
      const double z = may_meet ? depth_along(ray, object, 0.4, end) : end;
      const double error = noise * (2 * static_cast<double>(random()) / 4294967295.0 - 1);
      const double read = 1 / (1 / z + error / steps_per_inverse_metre);
      const bool is_read = on_disc || z < end;
      frame.depth.push_back(
          static_cast<std::uint16_t>(is_read ? std::lround(read / lens.depth_unit) : 0));
    }
  }
  return frame;
}

/// A turn with the true pose and the true angles, except for `offsets`: how far the platform stood
/// beyond the commanded angle at each stop, radians; 0 beyond the vector's end.
/// @param disc_normal  in the frame that turns
inline CalibrationTurn rendered_turn(
    const Shape& object, std::size_t stops, const std::vector<double>& offsets = {},
    const Eigen::Vector3d& disc_normal = Eigen::Vector3d::UnitZ()) {
  CalibrationTurn turn{.intrinsics = {}, .platform_from_sensor = true_platform_from_sensor()};
  std::mt19937 random(1);
  std::vector<DepthFrame> frames;
  for (std::size_t stop = 0; stop < stops; ++stop) {
    turn.angles.push_back(2 * std::numbers::pi * static_cast<double>(stop) /
                          static_cast<double>(stops));
    const double offset = stop < offsets.size() ? offsets[stop] : 0;
    frames.push_back(rendered_frame(object, turn.angles.back() + offset, random, disc_normal));
  }
  turn.read = [frames = std::move(frames)](std::size_t stop) { return frames[stop]; };
  return turn;
}

/// Deviation of a pose's axis from the true one.
struct AxisError {
  double direction_deg = 0;
  double position_mm = 0;  ///< 5 cm above the platform
  double height_mm = 0;
};

inline AxisError axis_error(const Eigen::Isometry3d& platform_from_sensor) {
  const Eigen::Isometry3d error = platform_from_sensor * true_platform_from_sensor().inverse();
  const Eigen::Vector3d axis = error.linear() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d above = 0.05 * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d off = error * above - above;
  return {.direction_deg = degrees_from_radians(std::atan2(axis.head<2>().norm(), axis.z())),
          .position_mm = mm_from_metres(off.head<2>().norm()),
          .height_mm = mm_from_metres(std::abs(off.z()))};
}

}  // namespace octurn
