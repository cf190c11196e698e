#include "bennett/marching_tetrahedra.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bennett/marching_tetrahedra_cases.hpp"
#include "octurn/units.hpp"
#include "parallel/fork_join.hpp"
#include "parallel/ordered_pipeline.hpp"

namespace octurn {
namespace {

/// Millimetres of the half-leaf positions of one pseudo-voxel brick, on each axis.
struct HalfStepPositions {
  static constexpr std::size_t count = 2 * Brick::side + 1;
  std::array<std::array<float, count>, 3> mm = {};

  HalfStepPositions(const BrickFrame& frame, const Index3& brick) {
    const std::array<int, 3> first{brick.x, brick.y, brick.z};
    const double half_leaf = frame.leaf_side / 2;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double corner = axis < 2 ? frame.low_xy : 0.0;
      for (std::size_t i = 0; i < count; ++i) {
        const double halves = 2.0 * Brick::side * first[axis] + 1 + static_cast<double>(i);
        mm[axis][i] = static_cast<float>(mm_from_metres(corner + halves * half_leaf));
      }
    }
  }
};

void append_facets(const BrickFrame& frame, const PseudoVoxelBrick& brick,
                   std::vector<Facet>& facets) {
  const HalfStepPositions positions(frame, brick.position);
  for_each_mixed(brick, [&](int x, int y, int z, std::size_t pattern) {
    const TetrahedraCase& surface = marching_tetrahedra_cases[pattern];
    const std::array<const float*, 3> mm{&positions.mm[0][static_cast<std::size_t>(2 * x)],
                                         &positions.mm[1][static_cast<std::size_t>(2 * y)],
                                         &positions.mm[2][static_cast<std::size_t>(2 * z)]};
    for (std::size_t i = 0; i < surface.count; ++i) {
      const CaseFacet& from = surface.facets[i];
      std::array<std::array<float, 3>, 3> corners;  // aligned, unlike those of a packed facet
      for (std::size_t corner = 0; corner < 3; ++corner) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          corners[corner][axis] = mm[axis][from.corners[corner][axis]];
        }
      }
      facets.push_back({.normal = from.normal, .corners = corners, .attributes = 0});
    }
  });
}

/// Some pseudo-voxel bricks of a layer, which they keep alive.
struct PseudoVoxelPiece {
  std::shared_ptr<const PseudoVoxelLayer> layer;
  std::span<const PseudoVoxelBrick> bricks;
};

/// Source of an `OrderedPipeline`: pieces of a layer, layer after layer, small enough that a
/// piece's facets take some hundred kilobytes.
class PieceSource {
 public:
  PieceSource(const Octree& octree, const BrickLayers& layers)
      : octree_(octree), next_(first_layer(layers)), end_(layers.end) {}

  std::optional<PseudoVoxelPiece> operator()() {
    constexpr std::size_t max_bricks = 2;
    while (rest_.empty() && next_ < end_) {
      layer_ = std::make_shared<const PseudoVoxelLayer>(pseudo_voxels(octree_, next_++));
      rest_ = layer_->bricks();
    }
    if (rest_.empty()) {
      return std::nullopt;
    }
    const auto bricks = rest_.first(std::min(max_bricks, rest_.size()));
    rest_ = rest_.subspan(bricks.size());
    return PseudoVoxelPiece{.layer = layer_, .bricks = bricks};
  }

 private:
  const Octree& octree_;
  int next_;
  int end_;
  std::shared_ptr<const PseudoVoxelLayer> layer_ = {};
  std::span<const PseudoVoxelBrick> rest_ = {};  // of the layer
};

}  // namespace

void marching_tetrahedra(const Octree& octree, const BrickLayers& layers, int threads,
                         const FacetSink& sink) {
  const BrickFrame frame{.low_xy = -octree.side() / 2, .leaf_side = octree.leaf_side()};
  OrderedPipeline<PieceSource, std::vector<Facet>> pieces(PieceSource(octree, layers), 4 * threads);
  fork_join(threads, [&](int) {
    pieces.run(
        [&](const PseudoVoxelPiece& piece, std::vector<Facet>& facets) {
          facets.clear();
          for (const PseudoVoxelBrick& brick : piece.bricks) {
            append_facets(frame, brick, facets);
          }
        },
        [&](const std::vector<Facet>& facets) { sink(facets); });
  });
}

void draw_layer(const BrickFrame& frame, int layer, std::vector<PlacedBrick> bricks,
                const FacetSink& sink) {
  constexpr std::size_t enough_facets = 8192;
  PseudoVoxelLayer pseudo_voxels(layer, std::move(bricks));
  pseudo_voxels.sort_by_rows();
  std::vector<Facet> facets;
  for (const PseudoVoxelBrick& brick : pseudo_voxels.bricks()) {
    append_facets(frame, brick, facets);
    if (facets.size() >= enough_facets) {
      sink(facets);
      facets.clear();
    }
  }
  if (!facets.empty()) {
    sink(facets);
  }
}

std::uint64_t count_facets(const Octree& octree, const BrickLayers& layers) {
  std::uint64_t count = 0;
  for (int layer = first_layer(layers); layer < layers.end; ++layer) {
    const PseudoVoxelLayer bricks = pseudo_voxels(octree, layer);
    for (const PseudoVoxelBrick& brick : bricks.bricks()) {
      for_each_mixed(brick, [&](int, int, int, std::size_t pattern) {
        count += marching_tetrahedra_cases[pattern].count;
      });
    }
  }
  return count;
}

void coarse_surface(Octree octree, std::uint64_t max_facets, const FacetSink& sink) {
  while (octree.levels() > 0 && count_facets(octree, all_layers(octree)) > max_facets) {
    octree = octree.at_level(octree.levels() - 1);
  }
  marching_tetrahedra(octree, all_layers(octree), 1, sink);
}

}  // namespace octurn
