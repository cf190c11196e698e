#include "register/nearest_points.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

}  // namespace octurn
