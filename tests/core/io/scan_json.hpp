#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "octurn/scan_folder.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {

/// A scan.json in the format of octurn/scan_folder.hpp, for the small image of tests/golden.
inline const nlohmann::json contract = nlohmann::json::parse(R"({
  "format": "octurn-scan", "version": 1,
  "sensor": {"name": "Kinect v1", "width": 4, "height": 3, "fx": 575.8, "fy": 570.5, "cx": 320.5,
             "cy": 240.25, "depth_unit_m": 0.0001},
  "calibration": {"platform_from_sensor": [[1, 0, 0, 0.01], [0, -0.6, 0.8, -0.62],
                                           [0, -0.8, -0.6, 0.4], [0, 0, 0, 1]]},
  "clip_m": {"min": [-0.14, -0.15, 0.002], "max": [0.14, 0.15, 0.4]},
  "snapshots": [{"file": "snapshots/000.png", "angle_deg": 0.0},
                {"file": "snapshots/001.png", "angle_deg": 90.0}]})");

/// Writes a scan folder whose first snapshot is the golden image. The second one's file is missing.
inline Scan write_contract_scan(const std::filesystem::path& folder) {
  put(folder / "scan.json", contract.dump());
  std::filesystem::create_directory(folder / "snapshots");
  std::filesystem::copy_file(std::filesystem::path(OCTURN_GOLDEN) / "depth_4x3.png",
                             folder / "snapshots" / "000.png");
  return read_scan(folder);
}

}  // namespace octurn
