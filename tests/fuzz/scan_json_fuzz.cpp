#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"

// Any text is refused by an Error of one line, or gives a scan with the properties that
// octurn/scan_folder.hpp promises.

namespace {

void require(bool promise) {
  if (!promise) {
    std::abort();
  }
}

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    check(octurn::parse_scan({reinterpret_cast<const char*>(data), size}));
  } catch (const octurn::Error& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos);
  }
  return 0;
}
