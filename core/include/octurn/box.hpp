#pragma once

#include <Eigen/Core>

namespace octurn {

/// An axis-aligned box, its faces included.
struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();
};

}  // namespace octurn
