#include "register/nearest_points.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "octurn/snapshot.hpp"
#include "parallel/fork_join.hpp"

namespace octurn {

using Eigen::Vector3d;
using Eigen::Vector3i;

NearestPoints::NearestPoints(std::vector<SurfacePoint> points) : points_(std::move(points)) {
  if (points_.empty()) {
    return;
  }
  Eigen::AlignedBox3d box;
  for (const SurfacePoint& point : points_) {
    box.extend(point.point);
  }
  middle_ = box.center();
  low_ = box.min() - Vector3d::Constant(cap);
  size_ = ((box.max() - low_).array() + cap)
              .matrix()
              .unaryExpr([](double side) { return std::ceil(side / voxel_side); })
              .cast<int>();
  const std::size_t count = index({0, 0, size_.z()});
  nearest_.resize(count, -1);
  std::vector<float> squares(count, static_cast<float>(cap * cap));
  const int reach = static_cast<int>(cap / voxel_side) + 1;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Vector3d at = (points_[i].point - low_) / voxel_side;
    const Vector3i voxel = at.array().floor().cast<int>();
    const Vector3i first = (voxel.array() - reach).max(0);
    const Vector3i last = (voxel.array() + reach).min(size_.array() - 1);
    for (int z = first.z(); z <= last.z(); ++z) {
      for (int y = first.y(); y <= last.y(); ++y) {
        const Eigen::Vector2d aside(y + 0.5 - at.y(), z + 0.5 - at.z());
        const double square_aside = aside.squaredNorm();
        if (square_aside * voxel_side * voxel_side >= cap * cap) {
          continue;
        }
        const std::size_t row = index({0, y, z});
        for (int x = first.x(); x <= last.x(); ++x) {
          const double along = x + 0.5 - at.x();
          const auto square =
              static_cast<float>((along * along + square_aside) * voxel_side * voxel_side);
          const std::size_t to = row + static_cast<std::size_t>(x);
          if (square < squares[to]) {
            squares[to] = square;
            nearest_[to] = static_cast<std::int32_t>(i);
          }
        }
      }
    }
  }
}

namespace {

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
