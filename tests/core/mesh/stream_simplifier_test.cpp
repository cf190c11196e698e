#include "mesh/stream_simplifier.hpp"

#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/random_field.hpp"
#include "tsdf/marching_cubes.hpp"

namespace octurn {
namespace {

TEST(StreamSimplifier, KeepsNoiseManifold) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const CompactTsdf field = random_field(seed, 0.2 * seed);
    const HoleFilledSdf filled(field, 3);
    std::vector<Facet> facets;
    StreamSimplifier simplifier(0.5, 4, [&](std::span<const Facet> some) {
      facets.insert(facets.end(), some.begin(), some.end());
    });
    const VoxelMask inside = filled.inside();
    marching_cubes(inside, filled, [&](const MeshPiece& piece) { simplifier.add(piece); });
    simplifier.finish();
    const std::vector<Facet> all = surface_of(inside, filled);
    EXPECT_LT(facets.size(), all.size());
    EXPECT_TRUE(topology_of(facets).manifold) << "seed " << seed;
    EXPECT_EQ(topology_of(facets).euler, topology_of(all).euler) << "seed " << seed;
  }
}

}  // namespace
}  // namespace octurn
