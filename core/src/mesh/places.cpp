#include <algorithm>
#include <cmath>

#include "octurn/mesh_report.hpp"

namespace octurn {

void Places::add(const Eigen::Vector3d& point) {
  const Eigen::Vector3d cell = (point / side_).array().floor();
  cells_.insert(
      {static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())});
  while (cells_.size() > max_count) {
    std::set<Cell> larger;
    for (const Cell& small : cells_) {
      larger.insert({small[0] >> 1, small[1] >> 1, small[2] >> 1});  // towards minus infinity
    }
    cells_ = std::move(larger);
    side_ *= 2;
  }
}

void Places::add(const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d along = corners[1] - corners[0];
  const Eigen::Vector3d across = corners[2] - corners[0];
  const double longest = std::max({along.norm(), across.norm(), (across - along).norm()});
  const int pieces = std::max(1, static_cast<int>(std::ceil(longest / side_)));
  for (int i = 0; i < pieces; ++i) {
    for (int j = 0; i + j < pieces; ++j) {
      add(corners[0] + (i + 1.0 / 3) / pieces * along + (j + 1.0 / 3) / pieces * across);
    }
  }
}

std::vector<Eigen::Vector3d> Places::centres() const {
  std::vector<Eigen::Vector3d> centres;
  centres.reserve(cells_.size());
  for (const Cell& cell : cells_) {
    centres.emplace_back((cell[0] + 0.5) * side_, (cell[1] + 0.5) * side_, (cell[2] + 0.5) * side_);
  }
  return centres;
}

}  // namespace octurn
