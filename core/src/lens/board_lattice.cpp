#include "lens/board_lattice.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <utility>

namespace octurn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector2i;

constexpr double max_bend = 0.25;  // of a step, from the midpoint of two neighbours
constexpr double min_sine = 0.15;  // of the angle between a board's axes in the picture

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Orders positions by row, then column.
struct ByRow {
  bool operator()(const Vector2i& a, const Vector2i& b) const {
    return std::pair(a.y(), a.x()) < std::pair(b.y(), b.x());
  }
};

using Lattice = std::map<Vector2i, std::size_t, ByRow>;

/// Grows connected pieces of lattice from seed corners by flood fill.
class Growth {
 public:
  Growth(std::span<const Vector2d> corners, std::span<const CornerEdges> edges)
      : corners_(corners), edges_(edges), places_(corners.size()) {}

  bool is_placed(std::size_t corner) const { return places_[corner].has_value(); }

  /// @param seed  a corner without a place
  Lattice from(std::size_t seed) {
    Lattice lattice;
    if (const auto axes = axes_of_seed(seed)) {
      place(lattice, seed, {0, 0}, *axes);
      while (!waiting_.empty()) {
        const std::size_t corner = waiting_.front();
        waiting_.pop_front();
        spread(lattice, corner);
      }
    }
    return lattice;
  }

 private:
  struct Place {
    Vector2i square = Vector2i::Zero();
    Vector2d columns = Vector2d::Zero();  // pixels, estimated step to the next column
    Vector2d rows = Vector2d::Zero();     // pixels, estimated step to the next row
  };

  Vector2d way(std::size_t from, std::size_t to) const { return corners_[to] - corners_[from]; }

  std::optional<Place> axes_of_seed(std::size_t seed) const {
    const CornerEdges& edges = edges_[seed];
    if (!edges.light_left[0] || !edges.dark_left[0]) {
      return std::nullopt;
    }
    Place axes{.columns = way(seed, *edges.light_left[0]), .rows = way(seed, *edges.dark_left[0])};
    if (cross(axes.columns, axes.rows) < 0) {
      axes.rows = -axes.rows;  // right-handed: the board is seen from the front
    }
    return axes;
  }

  void place(Lattice& lattice, std::size_t corner, const Vector2i& square, const Place& axes) {
    if (is_placed(corner) || lattice.contains(square)) {
      return;
    }
    places_[corner] = {.square = square, .columns = axes.columns, .rows = axes.rows};
    lattice[square] = corner;
    waiting_.push_back(corner);
  }

  /// Edges along X have light on their left at even corners, and those along Y at odd ones.
  void spread(Lattice& lattice, std::size_t corner) {
    const Place here = *places_[corner];
    const bool is_even = (here.square.x() + here.square.y()) % 2 == 0;
    const CornerEdges& edges = edges_[corner];
    for (const auto& end : is_even ? edges.light_left : edges.dark_left) {
      if (end) {
        step(lattice, corner, *end, Vector2i::UnitX());
      }
    }
    for (const auto& end : is_even ? edges.dark_left : edges.light_left) {
      if (end) {
        step(lattice, corner, *end, Vector2i::UnitY());
      }
    }
  }

  void step(Lattice& lattice, std::size_t from, std::size_t to, const Vector2i& axis) {
    Place next = *places_[from];
    const Vector2d along = way(from, to);
    Vector2d& step = axis.x() == 1 ? next.columns : next.rows;
    const double direction = step.dot(along) < 0 ? -1 : 1;
    step = direction * along;
    const double sine = cross(next.columns, next.rows) / (next.columns.norm() * next.rows.norm());
    if (sine >= min_sine) {
      place(lattice, to, next.square + static_cast<int>(direction) * axis, next);
    }
  }

  std::span<const Vector2d> corners_;
  std::span<const CornerEdges> edges_;
  std::vector<std::optional<Place>> places_;
  std::deque<std::size_t> waiting_ = {};
};

/// Whether a corner lies near the midpoint of its neighbours along an axis; true if one is missing.
bool is_straight(const Lattice& lattice, std::span<const Vector2d> corners, const Vector2i& square,
                 const Vector2i& axis) {
  const auto before = lattice.find(square - axis);
  const auto after = lattice.find(square + axis);
  if (before == lattice.end() || after == lattice.end()) {
    return true;
  }
  const Vector2d& first = corners[before->second];
  const Vector2d& last = corners[after->second];
  const Vector2d bend = corners[lattice.at(square)] - (first + last) / 2;
  return bend.norm() < max_bend * (last - first).norm() / 2;
}

}  // namespace

std::vector<LatticePlace> grow_lattice(std::span<const Vector2d> corners,
                                       std::span<const CornerEdges> edges) {
  Growth growth(corners, edges);
  Lattice largest;
  for (int least_edges : {4, 2}) {  // seeds with all four edges first: their axes are surest
    for (std::size_t seed = 0; seed < corners.size(); ++seed) {
      if (!growth.is_placed(seed) && edges[seed].count() >= least_edges) {
        if (Lattice piece = growth.from(seed); piece.size() > largest.size()) {
          largest = std::move(piece);
        }
      }
    }
  }
  std::vector<LatticePlace> places;
  for (const auto& [square, corner] : largest) {
    if (is_straight(largest, corners, square, Vector2i::UnitX()) &&
        is_straight(largest, corners, square, Vector2i::UnitY())) {
      places.push_back({.corner = corner, .square = square});
    }
  }
  return places;
}

}  // namespace octurn
