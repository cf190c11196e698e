#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// A recording in the layout of TUM's RGB-D data sets (Sturm, Engelhard, Endres, Burgard and
/// Cremers 2012): depth.txt lists depth images, 16-bit PNG of 1/5000 m, with their times;
/// groundtruth.txt has the pose of the camera's optical frame at other times. SLAM programs write
/// both.
struct TumRecording {
  struct Image {
    double time = 0;        ///< seconds
    std::string file = {};  ///< relative to the folder
    Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  ///< metres
  };
  std::vector<Image> images = {};  ///< images with a pose, in the order of depth.txt
  std::size_t without_pose = 0;    ///< number of depth images without a pose
};

/// Reads a recording's lists. An image's pose is that of its time, or interpolated between the two
/// around it if these are at most 0.1 s apart: positions linearly, rotations by slerp.
/// @param every  takes every n-th image, beginning with the first
/// @throws Error "scan-missing"    if a list is missing
/// @throws Error "scan-malformed"  with the file, the line and its error: a number missing or
///                                 malformed, a quaternion not of length one, a time that goes
///                                 back, a file outside the folder
/// @throws Error "scan-empty"      if no image has a pose
TumRecording read_tum_recording(const std::filesystem::path& folder, int every);

/// Returns the intrinsics of a recording's camera: "freiburg1", "freiburg2", "freiburg3" (as its
/// publishers calibrated them), "default" (of OpenNI), or "FX,FY,CX,CY" in pixels.
/// @throws Error "bad-settings"  if it is none of these
Intrinsics tum_camera(std::string_view camera);

/// Returns the camera's name in the name of a data set's folder, "rgbd_dataset_freiburg1_xyz"; else
/// "default".
std::string_view to_tum_camera(const std::filesystem::path& folder);

}  // namespace octurn
