#pragma once

#include <Eigen/Geometry>

#include "settings/field.hpp"

namespace octurn {

/// Access to a pose, metres; it must outlive this.
Access pose(Eigen::Isometry3d& value);

}  // namespace octurn
