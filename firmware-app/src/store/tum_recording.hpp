#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/snapshot.hpp"

namespace octurn {

/// A recording in the layout of TUM's RGB-D data sets (Sturm, Engelhard, Endres, Burgard and
/// Cremers 2012): depth.txt, or associations.txt, lists depth images, 16-bit PNG, with their times;
/// groundtruth.txt, or ICL-NUIM's *.gt.freiburg, has the pose of the camera's optical frame at
/// other times. SLAM programs write both.
struct TumRecording {
  struct Image {
    double time = 0;        ///< seconds
    std::string file = {};  ///< relative to the folder
    Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();  ///< metres
  };
  std::vector<Image> images = {};  ///< images with a pose, in the order of depth.txt
  std::size_t without_pose = 0;    ///< number of depth images without a pose
};

/// Reads a recording's lists, in any order of time. An image's pose is that of its time, or
/// interpolated between the two around it: positions linearly, rotations by slerp. Times may be in
/// seconds since 1970, or in thousandths, millionths or billionths of them. A pose that is no
/// number, or whose quaternion is 0, is one that the tracker had lost: images next to it have none.
/// @param every    takes every n-th image, beginning with the first
/// @param max_gap  seconds, between two poses to interpolate between
/// @throws Error "scan-missing"    if a list is missing
/// @throws Error "scan-malformed"  with the file, the line and its error: a number missing or
///                                 malformed, a quaternion not of length one, a file outside the
///                                 folder
/// @throws Error "scan-empty"      if no image has a pose
TumRecording read_tum_recording(const std::filesystem::path& folder, int every,
                                double max_gap = 0.1);

/// Returns the intrinsics of a recording's camera: "freiburg1", "freiburg2", "freiburg3" (as its
/// publishers calibrated them), "icl-nuim", "default" (of OpenNI), or "FX,FY,CX,CY" in pixels. The
/// depth unit is 1/5000 m. If FY is negative, the camera's Y points up: its poses need
/// `with_y_down`.
/// @throws Error "bad-settings"  if it is none of these
Intrinsics tum_camera(std::string_view camera);

/// Mirrors a pose whose camera's Y points up, as ICL-NUIM's: camera and world, so that it remains a
/// rotation.
Eigen::Isometry3d with_y_down(const Eigen::Isometry3d& world_from_camera);

/// Returns the camera's name in the name of a data set's folder, "rgbd_dataset_freiburg1_xyz", or
/// "icl-nuim" by its list of poses; else "default".
std::string_view to_tum_camera(const std::filesystem::path& folder);

}  // namespace octurn
