#include "bennett/leaf_figures.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <vector>

#include "bennett/marching_tetrahedra.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/units.hpp"
#include "support/random.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double root_side = 0.25;  // metres
constexpr int levels = 6;           // leaves of 3.9 mm, 8 layers of bricks
constexpr BrickLayers everything{.low = 0, .end = 8};

/// A thick hollow ball with a hole, which reaches through many bricks, on the root's bottom, and
/// random leaves in two of the root's corners.
Octree leaves() {
  Octree octree(root_side, levels);
  Random random(1);
  for (int z = 0; z < 64; ++z) {
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const double radius = (Vector3d(x, y, z) - Vector3d(31, 30, 20)).norm();
        const bool is_ball = radius < 21 && radius > 17 && x + y < 80;
        const bool is_corner = (x < 11 && y < 11 && z < 11) || (x > 50 && y > 50 && z > 50);
        if (is_ball || (is_corner && random.between(0, 2) == 0)) {
          octree.set({x, y, z});
        }
      }
    }
  }
  return octree;
}

std::vector<Facet> facets_of(const Octree& octree) {
  std::vector<Facet> facets;
  marching_tetrahedra(octree, everything, 1, [&](std::span<const Facet> piece) {
    facets.insert(facets.end(), piece.begin(), piece.end());
  });
  return facets;
}

/// The figures of some slabs of an octree.
LeafFigures figures_of(const Octree& octree, const std::vector<BrickLayers>& slabs = {everything}) {
  LeafFigures figures(octree);
  for (const BrickLayers& slab : slabs) {
    figures.add(octree, slab);
  }
  return figures;
}

TEST(LeafFigures, AreThoseOfTheFacets) {
  const Octree octree = leaves();
  MeshCheck check;
  check.add(facets_of(octree));
  const LeafFigures figures = figures_of(octree);
  EXPECT_TRUE(check.closed());
  EXPECT_TRUE(figures.closed());
  EXPECT_EQ(figures.leaves(), octree.leaf_count());
  // The facets' corners are rounded to 2^-18 mm or less, and cover 0.1 m2.
  EXPECT_NEAR(figures.volume(), m3_from_mm3(check.volume_mm3()), 1e-9 * 0.1);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(figures.bounds().min[axis], metres_from_mm(check.bounds_mm().min[axis]));
    EXPECT_EQ(figures.bounds().max[axis], metres_from_mm(check.bounds_mm().max[axis]));
  }
}

TEST(LeafFigures, AreTheSameInSlabs) {
  const Octree octree = leaves();
  const LeafFigures whole = figures_of(octree);
  const LeafFigures slabs = figures_of(octree, {{0, 1}, {1, 4}, {4, 5}, {5, 8}});
  EXPECT_TRUE(slabs.closed());
  EXPECT_EQ(slabs.leaves(), whole.leaves());
  EXPECT_EQ(slabs.volume(), whole.volume());
  EXPECT_EQ(slabs.bounds().min, whole.bounds().min);
  EXPECT_EQ(slabs.bounds().max, whole.bounds().max);
}

TEST(LeafFigures, SeeAMissingSlab) {
  const Octree octree = leaves();
  for (int layer = 0; layer < everything.end; ++layer) {
    const LeafFigures figures = figures_of(octree, {{0, layer}, {layer + 1, everything.end}});
    const std::array z{layer * Brick::side, (layer + 1) * Brick::side};
    const bool has_leaves = octree.leaf_count(layer, layer + 1) > 0;
    EXPECT_EQ(figures.closed(), !has_leaves) << z[0] << " to " << z[1];
  }
}

TEST(LeafFigures, SeeALeafThatOneOfTwoSlabsLacks) {
  const Octree octree = leaves();
  Octree other = leaves();
  other.set({5, 60, 16});
  LeafFigures figures(octree);
  figures.add(octree, {.low = 0, .end = 2});
  figures.add(other, {.low = 2, .end = 8});  // the leaf is in its lowest layer
  EXPECT_FALSE(figures.closed());
}

TEST(LeafFigures, HaveTheSurfaceWithinACellAndALeaf) {
  const Octree octree = leaves();
  const LeafFigures figures = figures_of(octree);
  for (const Facet& facet : facets_of(octree)) {
    const auto corners = facet.corners;
    const Vector3d corner = Eigen::Vector3f(corners[0].data()).cast<double>() * 1e-3;
    EXPECT_TRUE(figures.surface().has_near(corner, octree.leaf_side()));
  }
  EXPECT_FALSE(figures.surface().has_near({0, 0, 0.08}, 0.05));  // the ball's middle
}

TEST(LeafFigures, HaveTheSurfaceOfFineLeavesInFewCells) {
  Octree octree(root_side, 10);  // leaves of 0.24 mm: a cell for each brick
  for (int i = 0; i < 1024; ++i) {
    octree.set({i, 500, 300});
  }
  LeafFigures figures(octree);
  figures.add(octree, {.low = 0, .end = octree.brick_layers()});
  EXPECT_TRUE(figures.closed());
  for (int i = 0; i < 1024; ++i) {
    const Vector3d leaf = Vector3d(i - 512, 500 - 512, 300) * octree.leaf_side();
    EXPECT_TRUE(figures.surface().has_near(leaf, Brick::side * octree.leaf_side()));
  }
  EXPECT_FALSE(figures.surface().has_near({0, -0.01, 0.07}, 0.005));
}

TEST(LeafFigures, SampleLeavesEvenlyAndInAnySlabsTheSame) {
  const Octree octree = leaves();
  const std::vector<Vector3d> sample = figures_of(octree).sample();
  EXPECT_GT(sample.size(), LeafFigures::max_sample / 2);
  EXPECT_LE(sample.size(), LeafFigures::max_sample);
  EXPECT_EQ(figures_of(octree, {{0, 1}, {1, 4}, {4, 5}, {5, 8}}).sample(), sample);
  double high = 0;
  octree.for_each_brick([&](const Index3& brick, const Brick& bits) {
    for (int z = 0; z < Brick::side; ++z) {
      const bool is_high = Brick::side * brick.z + z >= 20;  // above the ball's middle
      high += is_high ? std::popcount(bits.layers[static_cast<std::size_t>(z)]) : 0;
    }
  });
  const auto sampled = static_cast<double>(std::ranges::count_if(
      sample, [&](const Vector3d& leaf) { return leaf.z() > 20 * octree.leaf_side(); }));
  EXPECT_NEAR(sampled / static_cast<double>(sample.size()),
              high / static_cast<double>(octree.leaf_count()), 0.02);
}

TEST(LeafFigures, OfNothingAreNotClosed) {
  EXPECT_FALSE(figures_of(Octree(root_side, levels)).closed());
}

}  // namespace
}  // namespace octurn
