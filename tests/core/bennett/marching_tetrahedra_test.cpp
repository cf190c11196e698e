#include "bennett/marching_tetrahedra.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "core/bennett/comparison.hpp"
#include "core/bennett/plain_octree.hpp"
#include "core/bennett/soup.hpp"
#include "core/mesh/surface.hpp"
#include "mesh/mesh_check.hpp"

namespace octurn {
namespace {

struct RandomLeaves {
  Octree octree;
  std::set<std::array<int, 3>> leaves = {};
};

/// Random leaves in a corner of the root, so that some touch the root's and the bricks' borders.
RandomLeaves random_leaves(std::uint32_t seed, int levels, int extent, int percent) {
  RandomLeaves random{.octree = Octree(1.0, levels)};
  Soup dice(seed, levels);
  for (int z = 0; z < extent; ++z) {
    for (int y = 0; y < extent; ++y) {
      for (int x = 0; x < extent; ++x) {
        if (dice.between(1, 100) <= percent) {
          random.octree.set({x, y, z});
          random.leaves.insert({x, y, z});
        }
      }
    }
  }
  return random;
}

TEST(MarchingTetrahedra, GivesTheTrianglesOfThePlainImplementation) {
  for (const auto& [levels, extent, percent] :
       {std::tuple{0, 1, 100}, {1, 2, 50}, {3, 8, 30}, {4, 16, 10}, {5, 20, 50}, {5, 32, 95}}) {
    const RandomLeaves random = random_leaves(5, levels, extent, percent);
    const std::vector<Facet> facets = surface_of(random.octree);
    EXPECT_EQ(in_half_leaves(random.octree, facets), plain::marching_tetrahedra(random.leaves))
        << extent << " leaves a side, " << percent << " %";
    EXPECT_EQ(count_facets(random.octree, all_layers(random.octree)), facets.size());
  }
}

TEST(MarchingTetrahedra, IsClosedAndManifoldWhateverTheLeaves) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const RandomLeaves random = random_leaves(seed, 5, 18, 5 + 12 * static_cast<int>(seed));
    const Topology topology = topology_of(surface_of(random.octree));
    EXPECT_TRUE(topology.closed);
    EXPECT_TRUE(topology.manifold);
  }
}

TEST(MarchingTetrahedra, OfOneLeafIsASphereInTopology) {
  Octree octree(1.0, 6);
  octree.set({20, 30, 40});
  EXPECT_EQ(topology_of(surface_of(octree)).euler, 2);
}

TEST(MarchingTetrahedra, OfARingOfLeavesIsATorusInTopology) {
  Octree octree(1.0, 6);
  for (int i = 0; i < 10; ++i) {
    octree.set({10 + i, 10, 15});
    octree.set({10 + i, 19, 15});
    octree.set({10, 10 + i, 15});
    octree.set({19, 10 + i, 15});
  }
  EXPECT_EQ(topology_of(surface_of(octree)).euler, 0);
}

TEST(MarchingTetrahedra, OfABlockHasItsBoxAndNormalsThatPointOutward) {
  Octree octree(1.0, 6);  // leaves of 15.625 mm
  for (int z = 0; z < 12; ++z) {
    for (int y = 20; y < 36; ++y) {
      for (int x = 30; x < 40; ++x) {
        octree.set({x, y, z});
      }
    }
  }
  const std::vector<Facet> facets = surface_of(octree);
  MeshCheck check;
  check.add(facets);
  constexpr double leaf = 15.625;
  EXPECT_EQ(check.bounds_mm().min, Eigen::Vector3d(30 * leaf - 500, 20 * leaf - 500, 0));
  EXPECT_EQ(check.bounds_mm().max, Eigen::Vector3d(40 * leaf - 500, 36 * leaf - 500, 12 * leaf));
  // Marching tetrahedra cut off half a leaf along the edges and nothing else: the volume lies
  // between that of the block and that of the box around the leaves' centres.
  EXPECT_LT(check.volume_mm3(), 10 * 16 * 12 * std::pow(leaf, 3));
  EXPECT_GT(check.volume_mm3(), 9 * 15 * 11 * std::pow(leaf, 3));

  const Eigen::Vector3d middle = (check.bounds_mm().min + check.bounds_mm().max) / 2;
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    const auto direction = facet.normal;
    const Eigen::Vector3d corner = Eigen::Vector3f(corners[0].data()).cast<double>();
    const Eigen::Vector3d normal = Eigen::Vector3f(direction.data()).cast<double>();
    EXPECT_NEAR(normal.norm(), 1.0, 1e-6);
    EXPECT_GT(normal.dot(corner - middle), 0);
  }
}

TEST(MarchingTetrahedra, OfNothingIsNothing) {
  EXPECT_TRUE(surface_of(Octree(1.0, 10)).empty());
  EXPECT_EQ(count_facets(Octree(1.0, 10), {.low = 0, .end = 128}), 0U);
}

}  // namespace
}  // namespace octurn
