#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "register/reading_fit.hpp"

namespace octurn {

/// A coarse volume around what turns saw that knows where one of them saw that nothing is.
class FreeSpace {
 public:
  /// @param turns  in one frame, which is that of the volume
  /// Space outside the box of their points, and a centimetre around it, is taken as free.
  /// @throws Stopped
  FreeSpace(std::span<const PlacedTurn> turns, int threads, const std::stop_token& stop);

  /// Whether nothing is at a point, to within a voxel.
  bool is_free(const Eigen::Vector3d& point) const {
    const Eigen::Vector3i at = ((point - low_) / voxel_side).array().floor().cast<int>();
    return (at.array() < 0).any() || (at.array() >= size_.array()).any() || free_[index(at)] != 0;
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
  std::vector<std::uint8_t> free_ = {};  // bytes, as threads write neighbours
};

}  // namespace octurn
