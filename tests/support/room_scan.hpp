#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <vector>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/tiles.hpp"
#include "octurn/units.hpp"

namespace octurn {

/// A room with furniture, seen by an ideal sensor that is carried through it. Each ray is
/// intersected with the room's box from inside and with the furniture's boxes from outside.
struct Room {
  Box walls = {};                   ///< metres
  std::vector<Box> furniture = {};  ///< metres
  Intrinsics lens = {};
};

/// A room of 6 x 5 x 2.5 m, seen by a Kinect. No side coincides with a leaf's face.
inline Room large_room() {
  return {.walls = {.min = {-3.013, -2.507, 0.103}, .max = {2.987, 2.493, 2.603}},
          .furniture = {{.min = {-2.9, -1.8, 0.1}, .max = {-0.9, -0.9, 0.55}},   // a sofa
                        {.min = {0.6, -0.5, 0.83}, .max = {2.0, 0.5, 0.86}},     // a table's top
                        {.min = {1.25, -0.05, 0.1}, .max = {1.35, 0.05, 0.83}},  // and its leg
                        {.min = {2.4, 1.2, 0.1}, .max = {2.98, 2.4, 2.1}},       // a cupboard
                        {.min = {-2.0, 2.2, 0.1}, .max = {0.0, 2.48, 1.0}}},     // shelves
          .lens = {.depth_unit = 0.0002}};
}

/// A chamber of 1.2 x 1 x 0.9 m with a box in it, seen in few samples to keep tests fast.
inline Room small_room() {
  return {.walls = {.min = {-0.613, -0.507, 0.053}, .max = {0.587, 0.493, 0.953}},
          .furniture = {{.min = {0.1, 0.1, 0.05}, .max = {0.35, 0.3, 0.4}}},
          .lens = {.width = 160,
                   .height = 120,
                   .fx = 120,
                   .fy = 120,
                   .cx = 80,
                   .cy = 60,
                   .depth_unit = 0.0002}};
}

/// The distances along a ray, in lengths of `ray`, at which it enters and leaves a box. The first
/// is greater than the second if the ray misses the box.
inline std::array<double, 2> meet(const Box& box, const Eigen::Vector3d& eye,
                                  const Eigen::Vector3d& ray) {
  double enters = std::numeric_limits<double>::lowest();
  double leaves = std::numeric_limits<double>::max();
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double a = (box.min[axis] - eye[axis]) / ray[axis];
    const double b = (box.max[axis] - eye[axis]) / ray[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return {enters, leaves};
}

/// The pose of snapshot `i`: near the room's centre, with headings that cover all sides.
inline Eigen::Isometry3d room_pose(const Room& room, int i) {
  constexpr double golden_angle = 2.399963;
  constexpr std::array pitches_deg{-35.0, 5.0, -15.0, 30.0, -55.0, 15.0, -5.0};
  Eigen::Matrix3d upright;  // optical X right, Y down, Z forward; looking along +Y, Z up
  upright << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Eigen::Vector3d middle = (room.walls.min + room.walls.max) / 2;
  const Eigen::Vector3d side = room.walls.max - room.walls.min;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() =
      Eigen::AngleAxisd(golden_angle * i, Eigen::Vector3d::UnitZ()) *
      Eigen::AngleAxisd(radians_from_degrees(pitches_deg[static_cast<std::size_t>(i) % 7]),
                        Eigen::Vector3d::UnitX()) *
      upright;
  pose.translation() =
      middle + Eigen::Vector3d(0.1 * side.x() * std::cos(0.7 * i),
                               0.1 * side.y() * std::sin(1.1 * i),
                               0.12 * side.z() * std::sin(0.3 * i) + 0.1 * side.z());
  return pose;
}

inline Snapshot room_snapshot(const Room& room, int i) {
  const Intrinsics& lens = room.lens;
  Snapshot snapshot{.frame = {.width = lens.width, .height = lens.height, .depth = {}},
                    .intrinsics = lens,
                    .object_from_sensor = room_pose(room, i)};
  const Eigen::Vector3d eye = snapshot.object_from_sensor.translation();
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector3d ray =
          snapshot.object_from_sensor.linear() *
          Eigen::Vector3d((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
      double z = meet(room.walls, eye, ray)[1];
      for (const Box& box : room.furniture) {
        const auto [enters, leaves] = meet(box, eye, ray);
        z = enters < leaves && enters > 0 ? std::min(z, enters) : z;
      }
      const double value = z / lens.depth_unit;
      snapshot.frame.depth.push_back(value < 65535 ? static_cast<std::uint16_t>(std::lround(value))
                                                   : std::uint16_t{0});
    }
  }
  return snapshot;
}

inline SnapshotSource room_scan(const Room& room, std::size_t count) {
  return {.count = count,
          .read = [room](std::size_t i) { return room_snapshot(room, static_cast<int>(i)); }};
}

/// Writes a scan of the room as a scan folder with free poses.
inline void write_room_scan(const std::filesystem::path& folder, const Room& room, int count) {
  Scan scan{.sensor_name = "test", .intrinsics = room.lens, .clip = everywhere};
  for (int i = 0; i < count; ++i) {
    write_depth_png(folder / shot_file(i), room_snapshot(room, i).frame);
    scan.shots.push_back({.file = shot_file(i), .object_from_sensor = room_pose(room, i)});
  }
  write_scan(folder, scan);
}

}  // namespace octurn
