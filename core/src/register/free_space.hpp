#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "register/nearest_points.hpp"
#include "register/reading_fit.hpp"

namespace octurn {

/// The free space of several turns, as a coarse voxel grid around their points.
class FreeSpace {
 public:
  /// Space more than a centimetre outside the box of the turns' points counts as free.
  ///
  /// @param turns  placed in one frame, which is the grid's
  /// @throws Stopped
  FreeSpace(std::span<const PlacedTurn> turns, int threads, const std::stop_token& stop);

  /// Whether a point lies in a voxel of free space. @param point  metres
  bool is_free(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d at = (point - low_) * (1 / voxel_side);
    return !is_inside(at, size_) || free_[index(at.cast<int>())] != 0;
  }

 private:
  static constexpr double voxel_side = 0.005;  // metres

  std::size_t index(const Eigen::Vector3i& voxel) const {
    return (static_cast<std::size_t>(voxel.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(voxel.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(voxel.x());
  }

  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<std::uint8_t> free_ = {};  // not bits, as threads write neighbouring voxels
};

}  // namespace octurn
