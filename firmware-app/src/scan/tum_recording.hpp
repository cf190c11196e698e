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
  std::vector<Image> images = {};  ///< that have a pose, in the order of depth.txt
  std::size_t without_pose = 0;    ///< depth images that have none
};

/// Reads a recording's lists. The pose of an image is that of its time, or between the two around
/// it if they are at most 0.1 s apart: positions linearly, directions by slerp.
/// @param every  takes one of so many images, the first one first
/// @throws Error "scan-missing"    if a list is not there
/// @throws Error "scan-malformed"  that names the file, the line and what is wrong with it: a
/// number
///                                 missing or none, a quaternion not of length one, a time that
///                                 goes back, a file outside the folder
/// @throws Error "scan-empty"      if no image has a pose
TumRecording read_tum_recording(const std::filesystem::path& folder, int every);

/// The camera of a recording: "freiburg1", "freiburg2", "freiburg3" (as its publishers calibrated
/// them), "default" (of OpenNI), or "FX,FY,CX,CY" in pixels.
/// @throws Error "bad-settings"  if it is none of these
Intrinsics tum_camera(std::string_view camera);

/// The camera that a data set's folder tells by its name, "rgbd_dataset_freiburg1_xyz"; else
/// "default".
std::string_view tum_camera_of(const std::filesystem::path& folder);

}  // namespace octurn
