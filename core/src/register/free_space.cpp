#include "register/free_space.hpp"

#include <atomic>

#include "octurn/snapshot.hpp"
#include "parallel/fork_join.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double margin = 0.010;  // metres around the points

bool any_contradicts(std::span<const PlacedTurn> turns,
                     const std::vector<Eigen::Isometry3d>& turn_from_object, const Vector3d& at) {
  for (std::size_t i = 0; i < turns.size(); ++i) {
    if (contradicts(*turns[i].turn, turn_from_object[i] * at)) {
      return true;
    }
  }
  return false;
}

}  // namespace

FreeSpace::FreeSpace(std::span<const PlacedTurn> turns, int threads, const std::stop_token& stop) {
  Eigen::AlignedBox3d box;
  std::vector<Eigen::Isometry3d> turn_from_object;
  for (const PlacedTurn& placed : turns) {
    turn_from_object.push_back(placed.object_from_turn.inverse());
    for (const SurfacePoint& point : placed.turn->points) {
      box.extend(placed.object_from_turn * point.point);
    }
  }
  if (box.isEmpty()) {
    return;
  }
  low_ = box.min() - Vector3d::Constant(margin);
  size_ = ((box.max() - low_).array() + margin)
              .matrix()
              .unaryExpr([](double side) { return std::ceil(side / voxel_side); })
              .cast<int>();
  free_.resize(index({0, 0, size_.z()}));
  std::atomic<int> next = 0;
  fork_join(threads, [&](int) {
    for (int z = next++; z < size_.z(); z = next++) {
      throw_if_stopped(stop);
      for (int y = 0; y < size_.y(); ++y) {
        for (int x = 0; x < size_.x(); ++x) {
          const Vector3d at = low_ + voxel_side * Vector3d(x + 0.5, y + 0.5, z + 0.5);
          free_[index({x, y, z})] = any_contradicts(turns, turn_from_object, at) ? 1 : 0;
        }
      }
    }
  });
}

}  // namespace octurn
