#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "fuzz/small_models.hpp"

// Any text is refused by an Error of one line, or gives a scan with the properties that
// octurn/scan_folder.hpp promises. From a small one a model is made, by depth images of all depths.

namespace {

using octurn::require;

void check_file(const std::string& file) {
  const std::filesystem::path there = ("/scan" / std::filesystem::path(file)).lexically_normal();
  require(there.string().starts_with("/scan/") && there.has_filename());
}

void check(const octurn::LaserCamera& camera) {
  require(!camera.lasers.empty());
  for (const octurn::Laser& laser : camera.lasers) {
    require(std::abs(laser.normal.norm() - 1) < 1e-9 && std::isfinite(laser.distance));
    require(!laser.source || laser.source->allFinite());
  }
}

void check(const octurn::Scan& scan) {
  const octurn::Intrinsics& intrinsics = scan.intrinsics;
  require(intrinsics.width > 0 && intrinsics.height > 0);
  require(intrinsics.fx > 0 && intrinsics.fy > 0 && intrinsics.depth_unit > 0);
  const Eigen::Matrix3d rotation = scan.platform_from_sensor.linear();
  require(std::abs(rotation.determinant() - 1.0) < 1e-3);
  require((scan.clip.min.array() < scan.clip.max.array()).all());
  require(!scan.shots.empty());
  if (scan.laser) {
    check(*scan.laser);
  }
  for (const octurn::Shot& shot : scan.shots) {
    require(std::isfinite(shot.angle));
    if (scan.laser) {
      require(shot.pictures.size() == scan.laser->lasers.size() + 1);
      std::for_each(shot.pictures.begin(), shot.pictures.end(), check_file);
    } else {
      check_file(shot.file);
    }
    require(shot.pose >= 0 &&
            static_cast<std::size_t>(shot.pose) < std::max<std::size_t>(scan.poses.size(), 1));
  }
  for (const octurn::ScanPose& pose : scan.poses) {
    require((pose.clip.min.array() < pose.clip.max.array()).all());
  }
}

/// A depth image of the scan's size: a tilted plane of all depths, with some pixels that lack one.
octurn::DepthFrame frame_of(const octurn::Intrinsics& lens, std::size_t shot) {
  octurn::DepthFrame frame{.width = lens.width, .height = lens.height};
  const int pixels = lens.width * lens.height;
  for (int i = 0; i < pixels; ++i) {
    frame.depth.push_back(i % 11 == 0 ? std::uint16_t{0}
                                      : static_cast<std::uint16_t>(1 + (65534 * i) / pixels));
  }
  if (shot % 2 == 1) {
    std::ranges::reverse(frame.depth);
  }
  return frame;
}

void reconstruct(const octurn::Scan& scan) {
  if (scan.laser || !is_small(scan)) {
    return;
  }
  make_models(scan, {.count = scan.shots.size(), .read = [&](std::size_t i) {
                       return octurn::Snapshot{
                           .frame = frame_of(scan.intrinsics, i),
                           .intrinsics = scan.intrinsics,
                           .object_from_sensor = model_pose(scan, scan.shots[i]),
                           .pose = scan.shots[i].pose};
                     }});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const octurn::Scan scan = octurn::parse_scan({reinterpret_cast<const char*>(data), size});
    check(scan);
    reconstruct(scan);
  } catch (const octurn::Error& error) {
    require_one_line(error);
  }
  return 0;
}
