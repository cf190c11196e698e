#include "mesh/surface_cells.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/places.hpp"

namespace octurn {
namespace {

using Cell = std::array<int, 3>;

constexpr int brick_side = 8;  // cells

Cell to_brick(const Cell& cell) { return {cell[0] >> 3, cell[1] >> 3, cell[2] >> 3}; }

std::size_t to_bit(const Cell& cell) {
  constexpr int mask = brick_side - 1;
  return static_cast<std::size_t>(((cell[2] & mask) * brick_side + (cell[1] & mask)) * brick_side +
                                  (cell[0] & mask));
}

Cell to_cell(const Eigen::Vector3d& point, double side) {
  const Eigen::Vector3d cell = (point / side).array().floor();
  return {static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())};
}

/// How far a coordinate is from a cell's, along one axis.
double gap(double at, int cell, double side) {
  return std::max({cell * side - at, at - (cell + 1) * side, 0.0});
}

}  // namespace

std::vector<SurfaceCells::PlacedBrick>::const_iterator SurfaceCells::lower_bound(
    const Cell& place) const {
  return std::ranges::lower_bound(bricks_, place, {}, &PlacedBrick::place);
}

void SurfaceCells::set(const Cell& cell) {
  const Cell place = to_brick(cell);
  const auto found = lower_bound(place);
  const auto index = found - bricks_.cbegin();
  if (found == bricks_.cend() || found->place != place) {
    bricks_.insert(found, PlacedBrick{.place = place, .cells = {}});
  }
  bricks_[static_cast<std::size_t>(index)].cells.set(to_bit(cell));
}

void SurfaceCells::make_coarser() {
  const std::vector<PlacedBrick> smaller = std::exchange(bricks_, {});
  for (const auto& [place, cells] : smaller) {
    for (std::size_t bit = 0; bit < cells.size(); ++bit) {
      if (cells[bit]) {
        const auto at = static_cast<int>(bit);
        set({(place[0] * brick_side + at % brick_side) >> 1,
             (place[1] * brick_side + at / brick_side % brick_side) >> 1,
             (place[2] * brick_side + at / brick_side / brick_side) >> 1});
      }
    }
  }
  side_ *= 2;
  last_.reset();
}

void SurfaceCells::add(const Eigen::Vector3d& point) {
  const Cell cell = to_cell(point, side_);
  if (cell == last_) {
    return;
  }
  last_ = cell;
  set(cell);
  while (bricks_.size() > max_bricks) {
    make_coarser();
  }
}

void SurfaceCells::add(const std::array<Eigen::Vector3d, 3>& corners) {
  spread_points(corners, side_, [this](const Eigen::Vector3d& point) { add(point); });
}

bool SurfaceCells::has(const Cell& cell) const {
  const Cell place = to_brick(cell);
  const auto found = lower_bound(place);
  return found != bricks_.end() && found->place == place && found->cells[to_bit(cell)];
}

bool SurfaceCells::has_near(const Eigen::Vector3d& point, double distance) const {
  if (has(to_cell(point, side_))) {
    return true;
  }
  const Eigen::Vector3d reach = Eigen::Vector3d::Constant(distance);
  const Cell low = to_cell(point - reach, side_);
  const Cell high = to_cell(point + reach, side_);
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) {
        const Eigen::Vector3d gaps(gap(point.x(), x, side_), gap(point.y(), y, side_),
                                   gap(point.z(), z, side_));
        if (gaps.squaredNorm() <= distance * distance && has({x, y, z})) {
          return true;
        }
      }
    }
  }
  return false;
}

}  // namespace octurn
