#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octurn/brick_map.hpp"
#include "octurn/distance_field.hpp"

namespace octurn {

/// What all snapshots together say of a sample.
enum class Sighted : std::uint8_t {
  unknown,
  behind,  // faintly seen, behind a surface
  free,    // seen through
  seen,    // near a surface that enough was seen of
};

/// 8 x 8 x 8 samples, x + 8 y + 64 z: distances to the surface, positive outside, in ticks, and two
/// bits for each of what is known.
struct SeenBrick {
  std::array<std::int16_t, FieldBrick::samples> distance = {};
  std::array<std::uint8_t, FieldBrick::samples / 4> sighted = {};

  Sighted at(std::size_t sample) const {
    return static_cast<Sighted>(sighted[sample / 4] >> sample % 4 * 2 & 3);
  }
  void set(std::size_t sample, Sighted value) {
    sighted[sample / 4] = static_cast<std::uint8_t>(sighted[sample / 4] |
                                                    static_cast<unsigned>(value) << sample % 4 * 2);
  }
};

/// What is left of a distance field when all snapshots are fused: less than half its size, so that
/// a field which is made in slabs has room as a whole.
class SeenField : public FieldShape {
 public:
  explicit SeenField(const FieldShape& shape);

  /// Takes over the layers that `field` holds.
  void add(const DistanceField& field);

  /// A brick, if it exists.
  const SeenBrick* find(const Cell& brick) const { return bricks_.find(brick_index(brick)); }

  /// Whether any snapshot saw through a cell.
  bool is_free(const Cell& cell) const { return free_[cell_index(cell)] != 0; }

  std::size_t bytes() const { return bricks_.bytes() + free_.capacity(); }

 private:
  BrickMap<SeenBrick> bricks_;
  std::vector<std::uint8_t> free_;
};

}  // namespace octurn
