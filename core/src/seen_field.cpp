#include "octurn/seen_field.hpp"

namespace octurn {
namespace {

// What a sample needs to count as seen: of one good reading a tenth, and no less than the snapshots
// that saw through.
constexpr float least_weight = 0.1F;

/// @param free  snapshots that saw through the sample
Sighted sighted(const FieldBrick& brick, std::size_t sample, int free) {
  const float w = static_cast<float>(brick.weight[sample]) / DistanceField::weight_ticks;
  if (w >= least_weight && w >= static_cast<float>(free)) {
    return Sighted::seen;
  }
  if (free > 0) {
    return Sighted::free;
  }
  return brick.distance[sample] < 0 && w > 0 ? Sighted::behind : Sighted::unknown;
}

/// @param position  of the brick
SeenBrick seen(const DistanceField& field, const FieldBrick& from, const Cell& position) {
  const int a_brick = field.cells_a_brick();
  const int leaves = field.cell_leaves();
  std::array<int, Brick::side> free{};  // of the samples of a row, by their cells
  SeenBrick brick{.distance = from.distance, .sighted = {}};
  std::size_t sample = 0;
  for (int z = 0; z < Brick::side; ++z) {
    for (int y = 0; y < Brick::side; ++y) {
      if (y % leaves == 0) {
        for (int x = 0; x < Brick::side; ++x) {
          free[static_cast<std::size_t>(x)] =
              field.free_cell({position.x * a_brick + x / leaves, position.y * a_brick + y / leaves,
                               position.z * a_brick + z / leaves});
        }
      }
      for (const int of_cell : free) {
        brick.set(sample, sighted(from, sample, of_cell + from.free[sample]));
        ++sample;
      }
    }
  }
  return brick;
}

}  // namespace

SeenField::SeenField(const FieldShape& shape)
    : FieldShape(shape), bricks_(brick_count()), free_(cell_count()) {}

void SeenField::add(const DistanceField& field) {
  const auto& [low, end] = field.layers();
  for (int z = low; z < end; ++z) {
    for (int y = 0; y < size().y; ++y) {
      for (int x = 0; x < size().x; ++x) {
        if (const FieldBrick* brick = field.find({x, y, z})) {
          bricks_.add(brick_index({x, y, z})) = seen(field, *brick, {x, y, z});
        }
      }
    }
  }
  const int a_brick = cells_a_brick();
  for (int z = low * a_brick; z < end * a_brick; ++z) {
    for (int y = 0; y < size().y * a_brick; ++y) {
      for (int x = 0; x < size().x * a_brick; ++x) {
        free_[cell_index({x, y, z})] = field.free_cell({x, y, z}) > 0 ? 1 : 0;
      }
    }
  }
}

}  // namespace octurn
