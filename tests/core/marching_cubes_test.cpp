#include "octurn/marching_cubes.hpp"

#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "core/random_field.hpp"
#include "core/surface.hpp"
#include "octurn/simplify.hpp"

namespace octurn {
namespace {

std::vector<Facet> surface_of(const LeafSet& set, const FilledField& filled) {
  std::vector<MeshVertex> vertices;
  std::vector<Facet> facets;
  marching_cubes(set, filled, [&](const MeshPiece& piece) {
    vertices.insert(vertices.end(), piece.vertices.begin(), piece.vertices.end());
    for (const MeshTriangle& t : piece.triangles) {
      facets.push_back(facet_of({vertices[t[0]], vertices[t[1]], vertices[t[2]]}));
    }
  });
  return facets;
}

/// Parts that no facet joins, counted over the corners they share.
int parts_of(const std::vector<Facet>& facets) {
  std::map<std::array<float, 3>, std::size_t> names;
  std::vector<std::size_t> parent;
  const auto root = [&](const std::array<float, 3>& corner) {
    const auto [found, is_new] = names.try_emplace(corner, parent.size());
    if (is_new) {
      parent.push_back(found->second);
    }
    std::size_t at = found->second;
    while (parent[at] != at) {
      parent[at] = parent[parent[at]];
      at = parent[at];
    }
    return at;
  };
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    parent[root(corners[1])] = root(corners[0]);
    parent[root(corners[2])] = root(corners[0]);
  }
  int parts = 0;
  for (std::size_t i = 0; i < parent.size(); ++i) {
    parts += parent[i] == i ? 1 : 0;
  }
  return parts;
}

TEST(MarchingCubes, IsClosedAndManifoldWhateverTheSigns) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const SeenField field = random_field(seed, 0.2 * seed);
    const FilledField filled(field, 3);
    const std::vector<Facet> facets = surface_of(filled.inside(), filled);
    ASSERT_GT(facets.size(), 1000U);
    EXPECT_TRUE(topology_of(facets).manifold) << "seed " << seed;
  }
}

TEST(MarchingCubes, OfAKeptPartIsOnePart) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const SeenField field = random_field(seed, 0.2 * seed);
    const FilledField filled(field, 3);
    LeafSet part = filled.inside();
    part.keep_part();
    part.fill_cavities();
    EXPECT_EQ(part.count_parts(), 1U);
    const std::vector<Facet> facets = surface_of(part, filled);
    EXPECT_EQ(parts_of(facets), 1) << "seed " << seed;
    EXPECT_TRUE(topology_of(facets).manifold) << "seed " << seed;
  }
}

TEST(MarchingCubes, KeepsVerticesApart) {
  const SeenField field = random_field(7, 0.4);
  const FilledField filled(field, 3);
  for (const Facet& facet : surface_of(filled.inside(), filled)) {
    const auto corners = facet.corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f a(corners[i].data());
      const Eigen::Vector3f b(corners[(i + 1) % 3].data());
      EXPECT_GT((a - b).norm(), 0.0355F);  // millimetres; 0.036, rounded
    }
  }
}

TEST(Simplifier, KeepsNoiseManifold) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const SeenField field = random_field(seed, 0.2 * seed);
    const FilledField filled(field, 3);
    std::vector<Facet> facets;
    Simplifier simplifier(0.5, 4, [&](std::span<const Facet> some) {
      facets.insert(facets.end(), some.begin(), some.end());
    });
    const LeafSet inside = filled.inside();
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
