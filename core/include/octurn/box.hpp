#pragma once

#include <Eigen/Core>

namespace octurn {

/// An axis-aligned box, its faces included.
struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();
};

inline bool contains(const Box& box, const Eigen::Vector3d& point) {
  return (point.array() >= box.min.array()).all() && (point.array() <= box.max.array()).all();
}

}  // namespace octurn
