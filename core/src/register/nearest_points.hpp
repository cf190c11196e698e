#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "register/reading_fit.hpp"
#include "register/stop_view.hpp"

namespace octurn {

/// Whether a point lies in a voxel grid.
/// @param at    in voxels, from the grid's lowest corner
/// @param size  in voxels
inline bool is_inside(const Eigen::Vector3d& at, const Eigen::Vector3i& size) {
  return at.x() >= 0 && at.y() >= 0 && at.z() >= 0 && at.x() < size.x() && at.y() < size.y() &&
         at.z() < size.z();
}

/// Nearest-neighbour lookup in constant time: a voxel grid that stores the point nearest to each
/// voxel.
class NearestPoints {
 public:
  /// Metres: maximum distance of a neighbour.
  static constexpr double cap = 0.012;

  explicit NearestPoints(std::vector<SurfacePoint> points);

  const std::vector<SurfacePoint>& points() const { return points_; }

  /// The middle of the points' bounding box.
  Eigen::Vector3d middle() const { return middle_; }

  /// Returns the point nearest to the centre of the 3 mm voxel around `point`; null if none is
  /// within `cap`.
  const SurfacePoint* find(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d at = (point - low_) * (1 / voxel_side);
    if (!is_inside(at, size_)) {
      return nullptr;
    }
    const std::int32_t nearest = nearest_[index(at.cast<int>())];
    return nearest < 0 ? nullptr : &points_[static_cast<std::size_t>(nearest)];
  }

 private:
  static constexpr double voxel_side = 0.003;

  std::size_t index(const Eigen::Vector3i& voxel) const {
    return (static_cast<std::size_t>(voxel.z()) * static_cast<std::size_t>(size_.y()) +
            static_cast<std::size_t>(voxel.y())) *
               static_cast<std::size_t>(size_.x()) +
           static_cast<std::size_t>(voxel.x());
  }

  std::vector<SurfacePoint> points_;
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i size_ = Eigen::Vector3i::Zero();
  std::vector<std::int32_t> nearest_ = {};
};

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
