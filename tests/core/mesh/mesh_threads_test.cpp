// Marching cubes, simplification and the search for self-intersections give the same bytes for any
// number of threads.

#include <gtest/gtest.h>

#include <algorithm>
#include <span>
#include <tuple>
#include <vector>

#include "core/mesh/shapes.hpp"
#include "core/mesh/surface.hpp"
#include "core/tsdf/random_field.hpp"
#include "mesh/qem_simplify.hpp"
#include "mesh/self_intersections.hpp"
#include "mesh/stream_simplifier.hpp"
#include "tsdf/marching_cubes.hpp"

namespace octurn {
namespace {

constexpr std::array<int, 4> team_sizes = {2, 3, 4, 7};

using Position = std::array<float, 3>;

/// A sphere with bumps of 0.05 mm, so that the costs of edge collapses differ everywhere.
LayeredMesh bumpy_sphere(std::uint32_t rings) {
  LayeredMesh mesh = sphere(30, rings);
  Random random(5);
  for (MeshVertex& vertex : mesh.vertices) {
    vertex.position[0] += static_cast<float>(random.between(-250, 250)) / 5000;
    vertex.position[1] += static_cast<float>(random.between(-250, 250)) / 5000;
  }
  return mesh;
}

IndexedMesh indexed(const LayeredMesh& shape, ThreadTeam& team) {
  IndexedMesh mesh{.vertices = shape.vertices,
                   .quadrics = std::vector<Quadric>(shape.vertices.size()),
                   .triangles = shape.triangles};
  add_plane_quadrics(mesh, 0, team);
  return mesh;
}

TEST(MeshThreads, MakeTheCollapsesOfOne) {
  const LayeredMesh shape = bumpy_sphere(70);
  const std::vector<char> locked(shape.vertices.size(), 0);
  const CollapseLimits limits{.target_error = 0.1};
  IndexedMesh expected = indexed(shape, ThreadTeam::alone());
  const IndexedMesh before = expected;
  qem_simplify(expected, locked, limits);
  ASSERT_LT(expected.triangles.size(), before.triangles.size() / 3);
  for (const int size : team_sizes) {
    ThreadTeam team(size);
    IndexedMesh mesh = indexed(shape, team);
    for (std::size_t i = 0; i < mesh.quadrics.size(); ++i) {
      ASSERT_EQ(mesh.quadrics[i].terms, before.quadrics[i].terms);
    }
    qem_simplify(mesh, locked, limits, {}, team);
    EXPECT_EQ(mesh.triangles, expected.triangles) << size;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      ASSERT_EQ(mesh.vertices[i].position, expected.vertices[i].position) << size;
      ASSERT_EQ(mesh.quadrics[i].terms, expected.quadrics[i].terms) << size;
    }
  }
}

TEST(MeshThreads, DrawThePiecesOfOne) {
  const CompactTsdf field = random_field(3, 0.4);
  const HoleFilledSdf filled(field, 3);
  const VoxelMask inside = filled.inside();
  struct Drawn {
    std::vector<Position> vertices = {};
    std::vector<MeshTriangle> triangles = {};
    std::vector<std::size_t> ends = {};
  };
  const auto drawn_by = [&](ThreadTeam& team) {
    Drawn drawn;
    marching_cubes(
        inside, filled,
        [&](const MeshPiece& piece) {
          std::ranges::transform(piece.vertices, std::back_inserter(drawn.vertices),
                                 &MeshVertex::position);
          drawn.triangles.insert(drawn.triangles.end(), piece.triangles.begin(),
                                 piece.triangles.end());
          drawn.ends.push_back(drawn.triangles.size());
        },
        {}, team);
    return drawn;
  };
  const Drawn expected = drawn_by(ThreadTeam::alone());
  ASSERT_GT(expected.ends.size(), 16U);
  for (const int size : team_sizes) {
    ThreadTeam team(size);
    const Drawn drawn = drawn_by(team);
    EXPECT_EQ(drawn.vertices, expected.vertices) << size;
    EXPECT_EQ(drawn.triangles, expected.triangles) << size;
    EXPECT_EQ(drawn.ends, expected.ends) << size;
  }
}

TEST(MeshThreads, SimplifySeveralWindowsAndNoiseAsOneDoes) {
  const CompactTsdf field = random_field(2, 0.4);
  const HoleFilledSdf filled(field, 3);
  const VoxelMask inside = filled.inside();
  const LayeredMesh shape = bumpy_sphere(120);  // 57,000 triangles; a window has 30,000
  const auto simplified_by = [&](ThreadTeam& team) {
    std::vector<Facet> facets;
    const auto append = [&](std::span<const Facet> some) {
      facets.insert(facets.end(), some.begin(), some.end());
    };
    StreamSimplifier noise(0.5, 4, append, {}, team);
    marching_cubes(inside, filled, [&](const MeshPiece& piece) { noise.add(piece); });
    noise.finish();
    StreamSimplifier sphere(0.2, 4, append, {}, team);
    stream(shape, 1, sphere);
    return facets;
  };
  const std::vector<Facet> expected = simplified_by(ThreadTeam::alone());
  for (const int size : {2, 5}) {
    ThreadTeam team(size);
    EXPECT_TRUE(same_bytes(simplified_by(team), expected)) << size;
  }
}

TEST(MeshThreads, FindTheSelfIntersectionsThatOneFinds) {
  LayeredMesh shape = bumpy_sphere(40);
  for (std::size_t i = 0; i < shape.vertices.size(); i += 97) {
    shape.vertices[i].position[2] += 9;  // through its neighbours' triangles
  }
  std::vector<Position> positions;
  std::ranges::transform(shape.vertices, std::back_inserter(positions), &MeshVertex::position);
  const auto found_by = [&](ThreadTeam& team) {
    std::vector<std::tuple<Position, Position>> boxes;
    for (const Aabb& box : self_intersections(positions, shape.triangles, 100, team)) {
      boxes.emplace_back(box.min, box.max);
    }
    std::ranges::sort(boxes);
    return boxes;
  };
  const auto expected = found_by(ThreadTeam::alone());
  ASSERT_GT(expected.size(), 20U);
  for (const int size : team_sizes) {
    ThreadTeam team(size);
    EXPECT_EQ(found_by(team), expected) << size;
  }
}

}  // namespace
}  // namespace octurn
