#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octurn/leaf_set.hpp"
#include "octurn/seen_field.hpp"

namespace octurn {

/// A distance field with a value everywhere: what no snapshot saw is filled in smoothly.
///
/// Leaves that are neither seen nor free take a harmonic function between the others, on the
/// field's cells. Below the foot each layer is as the foot's, and the model ends on the platform's
/// plane.
class FilledField {
 public:
  /// @param field  must outlive this
  /// @param foot   the lowest layer of leaves that counts; those below take its values
  FilledField(const SeenField& field, int foot);

  /// The box of leaves outside which there is nothing: from `low` up to but without `end`.
  const Cell& low() const { return low_; }
  const Cell& end() const { return end_; }

  double leaf_side() const { return field_.leaf_side(); }
  double centre(int leaf, std::size_t axis) const { return field_.centre(leaf, axis); }

  /// Half a leaf's side in ticks.
  float half_leaf() const {
    return static_cast<float>(field_.leaf_side() / 2 / field_.truncation() * FieldShape::ticks);
  }

  struct Value {
    float distance = 0;  // ticks, positive outside
    bool seen = false;
  };

  /// At the centre of a leaf of that box, or of one below it.
  Value at(const Cell& leaf) const;

  /// The leaves of that box at which the distance is negative, but for those on its sides and top.
  LeafSet inside() const;

 private:
  struct Grid {
    Cell size = {};
    std::vector<float> values = {};
    std::vector<char> known = {};
    std::size_t index(int x, int y, int z) const {
      return (static_cast<std::size_t>(z) * static_cast<std::size_t>(size.y) +
              static_cast<std::size_t>(y)) *
                 static_cast<std::size_t>(size.x) +
             static_cast<std::size_t>(x);
    }
  };

  void find_box();
  void classify();
  void classify(const Cell& cell, std::size_t index);

  struct Tally {
    int known = 0;
    float sum = 0;  // of distances, ticks
    void add(float distance) {
      ++known;
      sum += distance;
    }
  };
  Tally tally_of(const SeenBrick& brick, const Cell& position, const Cell& cell) const;
  static void solve(Grid& fine);
  static void relax(Grid& grid);
  static void relax(Grid& grid, int x, int y, int z);
  Sighted sighted(const Cell& leaf, const SeenBrick* brick) const;
  const SeenBrick* brick_at(const Cell& leaf) const;

  /// The first of two neighbouring cells, and how far it is from its centre to the other's.
  struct Between {
    int first = 0;
    float part = 0;
  };
  std::vector<Between> all_between(int leaves, int cells) const;
  float interpolated(const Between& x, const Between& y, const Between& z) const;
  float interpolated(const Cell& leaf) const;
  enum class Side { inside, outside, both };
  Side side_of(const Cell& brick) const;
  std::uint64_t inside(const Cell& first) const;
  void add_inside(const Cell& brick, LeafSet& set) const;

  const SeenField& field_;
  int foot_;
  Cell low_ = {};
  Cell end_ = {};
  Cell low_cell_ = {};
  Grid grid_ = {};
  std::array<std::vector<Between>, 3> between_ = {};  // of the box's leaves on each axis
};

}  // namespace octurn
