#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"

namespace octurn {

/// A pose as JSON has it everywhere: four rows of four numbers, metres.
nlohmann::json to_rows(const Eigen::Isometry3d& pose);

/// The pose of such rows.
/// @throws Error  of the value's code, if they are no rotation and translation within 10 m
Eigen::Isometry3d to_pose(const JsonValue& rows);

}  // namespace octurn
