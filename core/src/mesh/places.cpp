#include "mesh/places.hpp"

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
  spread_points(corners, side_, [this](const Eigen::Vector3d& point) { add(point); });
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
