#include <algorithm>
#include <bit>
#include <cstring>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "bennett/marching_tetrahedra.hpp"
#include "tiles/tile_lattice.hpp"
#include "tiles/tile_surface.hpp"
#include "voxel/octree.hpp"

namespace octurn {
namespace {

/// One layer of bricks of all tiles. Positions are in bricks from the origin of the object's frame.
struct Layer {
  std::vector<Index3> positions = {};
  std::vector<Brick> bricks = {};
};

/// Reads the bricks of all tiles layer by layer, from the bottom up.
class LayerReader {
 public:
  LayerReader(std::span<const StoredTile> tiles, const TileLattice& lattice)
      : tiles_(tiles), bricks_per_side_(lattice.bricks_per_side()) {}

  /// The lowest layer of bricks of all tiles, and one past the highest.
  int low() const { return tiles_.front().header().index.z * bricks_per_side_; }
  int end() const { return (tiles_.back().header().index.z + 1) * bricks_per_side_; }

  /// Reads a layer. Layers must be read one by one in ascending order.
  Layer read(int layer) {
    const int height = layer >= 0 ? layer / bricks_per_side_ : ~(~layer / bricks_per_side_);
    if (height != height_ || open_.empty()) {
      open(height);
    }
    Layer read;
    for (Open& tile : open_) {
      append(tile, layer - height * bricks_per_side_, read);
    }
    return read;
  }

 private:
  struct Open {
    const StoredTile* tile = nullptr;
    std::vector<TileBrick> positions = {};
    std::size_t next = 0;
  };

  void open(int height) {
    height_ = height;
    open_.clear();
    for (const StoredTile& tile : tiles_) {
      if (tile.header().index.z == height) {
        open_.push_back({.tile = &tile, .positions = tile.positions()});
      }
    }
  }

  void append(Open& open, int layer, Layer& to) const {
    const TileIndex& index = open.tile->header().index;
    const std::size_t first = open.next;
    while (open.next < open.positions.size() && open.positions[open.next].z == layer) {
      const TileBrick& at = open.positions[open.next++];
      const int half = bricks_per_side_ / 2;  // the middle of tile (0, 0, 0) is x = y = 0
      to.positions.push_back({index.x * bricks_per_side_ + at.x - half,
                              index.y * bricks_per_side_ + at.y - half,
                              index.z * bricks_per_side_ + layer});
    }
    const std::vector<std::byte> bytes = open.tile->bricks(first, open.next - first);
    const std::size_t end = to.bricks.size();
    to.bricks.resize(end + open.next - first);
    if (!bytes.empty()) {
      std::memcpy(&to.bricks[end], bytes.data(), bytes.size());
    }
  }

  std::span<const StoredTile> tiles_;
  int bricks_per_side_;
  int height_ = 0;
  std::vector<Open> open_ = {};
};

/// The bricks that `draw_layer` needs: one layer, and the bricks above it with leaves in their
/// bottom layer.
std::vector<PlacedBrick> placed(const Layer& here, const Layer& above) {
  std::vector<PlacedBrick> bricks;
  for (std::size_t i = 0; i < here.bricks.size(); ++i) {
    bricks.push_back({here.positions[i], &here.bricks[i]});
  }
  for (std::size_t i = 0; i < above.bricks.size(); ++i) {
    if (above.bricks[i].layers[0] != 0) {
      bricks.push_back({above.positions[i], &above.bricks[i]});
    }
  }
  return bricks;
}

std::uint64_t leaf_count(const Layer& layer) {
  std::uint64_t count = 0;
  for (const Brick& brick : layer.bricks) {
    for (const std::uint64_t leaves : brick.layers) {
      count += static_cast<std::uint64_t>(std::popcount(leaves));
    }
  }
  return count;
}

}  // namespace

SurfaceCount leaf_surface(std::span<const StoredTile> tiles, const FacetSink& sink,
                          const std::stop_token& stop) {
  const TileLattice lattice(tiles.front().header().options);
  const BrickFrame frame{.low_xy = 0, .leaf_side = lattice.leaf_side()};
  LayerReader reader(tiles, lattice);
  SurfaceCount count;
  Layer here;
  for (int layer = reader.low() - 1; layer < reader.end(); ++layer) {
    throw_if_stopped(stop);
    Layer above = layer + 1 < reader.end() ? reader.read(layer + 1) : Layer{};
    count.leaves += leaf_count(above);
    draw_layer(frame, layer, placed(here, above), [&](std::span<const Facet> facets) {
      throw_if_stopped(stop);
      count.facets += facets.size();
      sink(facets);
    });
    here = std::move(above);
  }
  return count;
}

}  // namespace octurn
