#pragma once

#include <filesystem>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"

namespace octurn {

/// Writes a scan folder: a horizontal square of 8 cm over the platform's centre, seen from above at
/// each stop. Its depth images hold a single distance, so it needs no sensor.
inline Scan write_small_scan(const std::filesystem::path& folder, int snapshots) {
  Scan scan{.sensor_name = "test",
            .clip = {.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}}};
  // Looks straight down from 0.7 m, so the square is 5 cm above the platform.
  scan.platform_from_sensor.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  scan.platform_from_sensor.translation() = Eigen::Vector3d(0, 0, 0.7);
  DepthFrame frame{.width = 640, .height = 480, .depth = std::vector<std::uint16_t>(640 * 480)};
  for (int v = 205; v < 275; ++v) {
    for (int u = 285; u < 355; ++u) {
      frame.depth[static_cast<std::size_t>(v * 640 + u)] = 6500;  // tenths of a millimetre
    }
  }
  for (int i = 0; i < snapshots; ++i) {
    scan.shots.push_back({.file = shot_file(i), .angle = i * 6.283185307179586 / snapshots});
    write_depth_png(folder / shot_file(i), frame);
  }
  write_scan(folder, scan);
  return scan;
}

}  // namespace octurn
