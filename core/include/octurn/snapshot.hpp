#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <functional>
#include <stop_token>

#include "octurn/box.hpp"
#include "octurn/depth_frame.hpp"

namespace octurn {

/// One stop of the platform: a filtered, unclipped depth image and the pose it was taken from.
struct Snapshot {
  DepthFrame frame = {};  ///< of the intrinsics' size
  Intrinsics intrinsics = {};
  /// Optical frame to the object's frame, metres (`object_from_sensor` in platform_pose.hpp).
  Eigen::Isometry3d object_from_sensor = Eigen::Isometry3d::Identity();
  int pose = 0;  ///< of a scan of several poses, its index
};

/// How the object lay on the platform in one of several poses.
struct Placement {
  /// Platform frame of the pose, at angle 0, to the object's frame, metres.
  Eigen::Isometry3d object_from_platform = Eigen::Isometry3d::Identity();
  Box clip = {};  ///< metres, platform frame of the pose
};

/// Snapshots that can be read, and read again, by several threads at once.
struct SnapshotSource {
  std::size_t count = 0;
  std::function<Snapshot(std::size_t)> read = {};  ///< of an index below `count`
};

/// Thrown by a call whose stop token was requested to stop before the call had its result; also by
/// a source or a sink, to lead out of a reconstruction. It is no `Error`: nothing went wrong.
struct Stopped {};

/// @throws Stopped  if a stop was requested
inline void throw_if_stopped(const std::stop_token& stop) {
  if (stop.stop_requested()) {
    throw Stopped{};
  }
}

}  // namespace octurn
