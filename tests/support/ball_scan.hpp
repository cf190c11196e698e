#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>

#include "octurn/png.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"

namespace octurn {

// A ball above the platform, seen by an ideal sensor: each ray is intersected with the sphere.

inline const Eigen::Vector3d ball_centre{0.01, -0.005, 0.06};  // metres, platform frame
inline constexpr double ball_radius = 0.05;
inline const Box ball_clip{.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}};

/// A quarter of a Kinect's samples along each axis, so that tests are quick.
inline constexpr Intrinsics few_samples{
    .width = 160, .height = 120, .fx = 144, .fy = 144, .cx = 80, .cy = 60, .depth_unit = 0.0001};

/// A sensor 0.6 m from the platform's axis and 0.3 m above it, looking along +Y and 25 degrees
/// down.
inline Eigen::Isometry3d ball_sensor_pose() {
  Eigen::Matrix3d upright;  // optical X right, Y down, Z forward, in the platform's axes
  upright << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(radians_from_degrees(-25), Eigen::Vector3d::UnitX()) * upright;
  pose.translation() = Eigen::Vector3d(0, -0.6, 0.34);
  return pose;
}

inline Snapshot ball_snapshot(double angle, const Intrinsics& lens = few_samples) {
  Snapshot snapshot{.frame = {.width = lens.width, .height = lens.height, .depth = {}},
                    .intrinsics = lens,
                    .object_from_sensor = object_from_sensor(ball_sensor_pose(), angle)};
  const Eigen::Vector3d centre = snapshot.object_from_sensor.inverse() * ball_centre;
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector3d ray((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
      const double along = ray.dot(centre);
      const double square =
          along * along - ray.squaredNorm() * (centre.squaredNorm() - ball_radius * ball_radius);
      const double z = square > 0 ? (along - std::sqrt(square)) / ray.squaredNorm() : 0;
      snapshot.frame.depth.push_back(static_cast<std::uint16_t>(std::lround(z / lens.depth_unit)));
    }
  }
  return snapshot;
}

inline double ball_angle(std::size_t i, std::size_t count) {
  return 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
}

/// One turn of `count` snapshots.
inline SnapshotSource ball_scan(std::size_t count) {
  return {.count = count,
          .read = [count](std::size_t i) { return ball_snapshot(ball_angle(i, count)); }};
}

/// Writes such a turn as a scan folder, at the size of a Kinect's image.
inline void write_ball_scan(const std::filesystem::path& folder, int count) {
  Scan scan{.sensor_name = "test",
            .intrinsics = {},
            .platform_from_sensor = ball_sensor_pose(),
            .clip = ball_clip};
  for (int i = 0; i < count; ++i) {
    const double angle = ball_angle(static_cast<std::size_t>(i), static_cast<std::size_t>(count));
    scan.shots.push_back({.file = shot_file(i), .angle = angle});
    write_depth_png(folder / shot_file(i), ball_snapshot(angle, scan.intrinsics).frame);
  }
  write_scan(folder, scan);
}

}  // namespace octurn
