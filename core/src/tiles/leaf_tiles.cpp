#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <iterator>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "bennett/marching_tetrahedra.hpp"
#include "bennett/triangulate.hpp"
#include "bennett/voxelize_triangle.hpp"
#include "depth/back_project.hpp"
#include "parallel/fork_join.hpp"
#include "tiles/make_tiles.hpp"
#include "tiles/tile_lattice.hpp"
#include "voxel/octree.hpp"

namespace octurn {
namespace {

using Octrees = std::map<TileIndex, Octree>;

Octrees make_octrees(const TileLattice& lattice, std::span<const Tile> tiles) {
  Octrees octrees;
  for (const Tile& tile : tiles) {
    octrees.try_emplace(tile.index, lattice.root_side(), lattice.levels());
  }
  return octrees;
}

/// Voxelizes triangles into the octrees of all tiles that they overlap.
class TileVoxelizer {
 public:
  TileVoxelizer(const TileLattice& lattice, Octrees& octrees)
      : lattice_(lattice), octrees_(octrees) {}

  void add(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
    std::array<int, 3> low{};
    std::array<int, 3> high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto tile = [&](std::int64_t at) { return lattice_.tile_at(lattice_.leaf_at(at)); };
      low[axis] = tile(std::min({a[axis], b[axis], c[axis]}));
      high[axis] = tile(std::max({a[axis], b[axis], c[axis]}));
    }
    for (int z = low[2]; z <= high[2]; ++z) {
      for (int y = low[1]; y <= high[1]; ++y) {
        for (int x = low[0]; x <= high[0]; ++x) {
          add_to({.x = x, .y = y, .z = z}, a, b, c);
        }
      }
    }
  }

 private:
  void add_to(const TileIndex& tile, const LatticePoint& a, const LatticePoint& b,
              const LatticePoint& c) {
    if (!(tile == last_) || octree_ == nullptr) {
      const auto found = octrees_.find(tile);
      last_ = tile;
      octree_ = found == octrees_.end() ? nullptr : &found->second;
    }
    if (octree_ != nullptr) {
      voxelize_triangle(*octree_, lattice_.in_tile(a, tile), lattice_.in_tile(b, tile),
                        lattice_.in_tile(c, tile), {}, lattice_.leaf_bits());
    }
  }

  const TileLattice& lattice_;
  Octrees& octrees_;
  TileIndex last_ = {};       // neighbouring triangles mostly lie in the same tile
  Octree* octree_ = nullptr;  // of `last_`; null if that tile is not made
};

void voxelize(const Snapshot& snapshot, const ReconstructOptions& options,
              const TileLattice& lattice, Octrees& octrees) {
  PointGrid grid = world_points(snapshot);
  clip(grid, options.clip);
  TileVoxelizer voxelizer(lattice, octrees);
  triangulate(grid, static_cast<float>(options.threshold),
              [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
                const auto p = lattice.snap(a);
                const auto q = lattice.snap(b);
                const auto r = lattice.snap(c);
                if (p && q && r) {
                  voxelizer.add(*p, *q, *r);
                }
              });
}

bool has_leaves(const Brick& brick) {
  return std::ranges::any_of(brick.layers, [](std::uint64_t leaves) { return leaves != 0; });
}

TileBricks to_bricks(const Octree& octree) {
  struct Found {
    TileBrick position;
    const Brick* brick;
  };
  std::vector<Found> found;
  octree.for_each_brick([&](const Index3& at, const Brick& brick) {
    if (has_leaves(brick)) {
      found.push_back({{.x = static_cast<std::uint16_t>(at.x),
                        .y = static_cast<std::uint16_t>(at.y),
                        .z = static_cast<std::uint16_t>(at.z)},
                       &brick});
    }
  });
  std::ranges::sort(found, [](const Found& a, const Found& b) {
    return std::tie(a.position.z, a.position.y, a.position.x) <
           std::tie(b.position.z, b.position.y, b.position.x);
  });
  TileBricks tile;
  tile.bricks.resize(found.size() * sizeof(Brick));
  for (std::size_t i = 0; i < found.size(); ++i) {
    tile.positions.push_back(found[i].position);
    std::memcpy(&tile.bricks[i * sizeof(Brick)], found[i].brick, sizeof(Brick));
  }
  return tile;
}

}  // namespace

void make_leaf_tiles(const ReconstructOptions& options, std::span<const Tile> tiles,
                     const SnapshotSource& snapshots, const TileSink& sink,
                     const std::stop_token& stop) {
  const TileLattice lattice(options);
  const int threads = std::max(1, std::min(options.threads, static_cast<int>(snapshots.count)));
  std::vector<Octrees> octrees(static_cast<std::size_t>(threads));
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int thread) {
    Octrees& own = octrees[static_cast<std::size_t>(thread)];
    own = make_octrees(lattice, tiles);
    for (std::size_t shot = next++; shot < snapshots.count; shot = next++) {
      throw_if_stopped(stop);
      voxelize(snapshots.read(shot), options, lattice, own);
    }
  });
  for (const Tile& tile : tiles) {
    throw_if_stopped(stop);
    Octree& octree = octrees.front().at(tile.index);
    for (std::size_t i = 1; i < octrees.size(); ++i) {
      octree.merge(octrees[i].at(tile.index));
      octrees[i].erase(tile.index);
    }
    sink(tile, to_bricks(octree));
    octrees.front().erase(tile.index);
  }
}

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
