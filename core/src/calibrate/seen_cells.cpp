#include "calibrate/seen_cells.hpp"

#include <algorithm>

namespace octurn {

ObjectCell to_object_cell(const Eigen::Vector3d& point) {
  const Eigen::Vector3d cell = (point / object_cell_side).array().floor();
  return {static_cast<std::int16_t>(cell.x()), static_cast<std::int16_t>(cell.y()),
          static_cast<std::int16_t>(cell.z())};
}

Eigen::Vector3d find_middle(const ObjectCell& cell) {
  return object_cell_side * Eigen::Vector3d(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5);
}

std::vector<ObjectCell> cells_of_several(std::span<const std::vector<ObjectCell>* const> stops) {
  std::vector<ObjectCell> all;
  for (const std::vector<ObjectCell>* stop : stops) {
    all.insert(all.end(), stop->begin(), stop->end());
  }
  std::ranges::sort(all);
  std::vector<ObjectCell> several;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i] == all[i - 1] && (several.empty() || several.back() != all[i])) {
      several.push_back(all[i]);
    }
  }
  return several;
}

}  // namespace octurn
