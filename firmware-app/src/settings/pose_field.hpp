#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "octurn/json_object.hpp"
#include "settings/field.hpp"

namespace octurn {

/// Returns access to a pose, metres; `value` must outlive it.
Access pose(Eigen::Isometry3d& value);

/// JSON of a pose, the same in all files and the API: four rows of four numbers, metres.
nlohmann::json to_rows(const Eigen::Isometry3d& pose);

/// Parses such rows.
/// @throws Error  with the code of `rows`, if they are not a rotation and a translation within 10 m
Eigen::Isometry3d to_pose(const JsonValue& rows);

}  // namespace octurn
