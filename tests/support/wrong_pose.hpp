#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "octurn/units.hpp"
#include "rig/nominal_pose.hpp"

namespace octurn {

/// platform_from_sensor of the nominal rig, off by 2 cm and 2 degrees.
inline Eigen::Isometry3d wrong_pose() {
  return Eigen::Translation3d(0.012, -0.016, 0) *
         Eigen::AngleAxisd(radians_from_degrees(2), Eigen::Vector3d::UnitX()) *
         nominal_platform_from_sensor();
}

/// A pose in the format of the settings: four rows of four numbers.
inline nlohmann::json to_rows(const Eigen::Isometry3d& pose) {
  nlohmann::json rows = nlohmann::json::array();
  for (int row = 0; row < 4; ++row) {
    rows.push_back({pose(row, 0), pose(row, 1), pose(row, 2), pose(row, 3)});
  }
  return rows;
}

}  // namespace octurn
