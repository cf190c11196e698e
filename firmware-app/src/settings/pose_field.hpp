#pragma once

#include <Eigen/Geometry>

#include "settings/field.hpp"

namespace octurn {

/// Returns access to a pose, metres; `value` must outlive it.
Access pose(Eigen::Isometry3d& value);

}  // namespace octurn
