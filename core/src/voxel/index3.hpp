#pragma once

namespace octurn {

/// Integer coordinates of a leaf, voxel or brick, counted from the lowest corner of its grid.
struct Index3 {
  int x = 0;
  int y = 0;
  int z = 0;
  friend bool operator==(const Index3&, const Index3&) = default;
};

/// Half-open range of layers of bricks along z: `low` up to but without `end`.
struct BrickLayers {
  int low = 0;
  int end = 0;
};

}  // namespace octurn
