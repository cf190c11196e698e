#include "bennett/marching_tetrahedra.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

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

namespace {

using Corner = int;  // bit 0: x, bit 1: y, bit 2: z

constexpr std::array<std::array<Corner, 4>, 6> tetrahedra{
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

HalfSteps middle(Corner a, Corner b) {
  HalfSteps steps{};
  for (int axis = 0; axis < 3; ++axis) {
    steps[static_cast<std::size_t>(axis)] =
        static_cast<std::int8_t>((a >> axis & 1) + (b >> axis & 1));
  }
  return steps;
}

/// Adds a facet, turned so that the corner `inside` lies behind it.
void add_facet(TetrahedraCase& surface, HalfSteps a, HalfSteps b, HalfSteps c, Corner inside) {
  std::array<int, 3> ab{};
  std::array<int, 3> ac{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ab[axis] = b[axis] - a[axis];
    ac[axis] = c[axis] - a[axis];
  }
  std::array<int, 3> normal{ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                            ab[0] * ac[1] - ab[1] * ac[0]};
  const HalfSteps from = middle(inside, inside);
  int ahead = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ahead += normal[axis] * (a[axis] - from[axis]);
  }
  const int sign = ahead < 0 ? -1 : 1;
  const int square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  CaseFacet& facet = surface.facets[surface.count++];
  facet.corners = sign < 0 ? std::array{a, c, b} : std::array{a, b, c};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    facet.normal[axis] =
        static_cast<float>(sign * normal[axis]) / std::sqrt(static_cast<float>(square));
  }
}

void add_tetrahedron(TetrahedraCase& surface, const std::array<Corner, 4>& tetrahedron,
                     int pattern) {
  std::array<Corner, 4> in{};
  std::array<Corner, 4> out{};
  std::size_t ins = 0;
  std::size_t outs = 0;
  for (const Corner corner : tetrahedron) {
    (pattern >> corner & 1 ? in[ins++] : out[outs++]) = corner;
  }
  if (ins == 1) {
    add_facet(surface, middle(in[0], out[0]), middle(in[0], out[1]), middle(in[0], out[2]), in[0]);
    --surface.excess;
  } else if (ins == 2) {
    const HalfSteps a = middle(in[0], out[0]);
    const HalfSteps c = middle(in[1], out[1]);
    add_facet(surface, a, middle(in[0], out[1]), c, in[0]);
    add_facet(surface, a, c, middle(in[1], out[0]), in[1]);
  } else if (ins == 3) {
    add_facet(surface, middle(in[0], out[0]), middle(in[1], out[0]), middle(in[2], out[0]), in[0]);
    ++surface.excess;
  }
}

std::array<TetrahedraCase, 256> all_patterns() {
  std::array<TetrahedraCase, 256> surfaces{};
  for (int pattern = 0; pattern < 256; ++pattern) {
    for (const std::array<Corner, 4>& tetrahedron : tetrahedra) {
      add_tetrahedron(surfaces[static_cast<std::size_t>(pattern)], tetrahedron, pattern);
    }
  }
  return surfaces;
}

}  // namespace

const std::array<TetrahedraCase, 256> marching_tetrahedra_cases = all_patterns();

}  // namespace octurn
