// No solid model intersects itself. The check is CGAL's, which shares no code with Octurn: exact
// predicates on the vertices as the file has them.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <iterator>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/random_field.hpp"
#include "core/tsdf/simulated_scan.hpp"
#include "mesh/stream_simplifier.hpp"
#include "octurn/scan_folder.hpp"
#include "tsdf/marching_cubes.hpp"

namespace octurn {
namespace {

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

/// Welds facets into a mesh where corners are bit-equal. Fails if the mesh is not manifold.
Mesh welded(std::span<const Facet> facets) {
  Mesh mesh;
  std::map<std::array<float, 3>, Mesh::Vertex_index> vertices;
  for (const Facet& facet : facets) {
    const auto positions = facet.corners;
    std::array<Mesh::Vertex_index, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [found, is_new] = vertices.try_emplace(positions[i]);
      if (is_new) {
        found->second = mesh.add_vertex(Point(static_cast<double>(positions[i][0]),
                                              static_cast<double>(positions[i][1]),
                                              static_cast<double>(positions[i][2])));
      }
      corners[i] = found->second;
    }
    EXPECT_NE(mesh.add_face(corners[0], corners[1], corners[2]), Mesh::null_face());
  }
  return mesh;
}

/// Counts the pairs of triangles that intersect or overlap.
std::size_t self_intersections(std::span<const Facet> facets) {
  const Mesh mesh = welded(facets);
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
  return pairs.size();
}

void expect_no_cuts(const std::vector<Snapshot>& snapshots) {
  for (const double leaf_size : {0.002, 0.001}) {
    for (const double target_error : {0.0, 0.00004, 0.0005}) {
      ReconstructOptions options = scan_options(leaf_size);
      options.target_error = target_error;
      const SolidModel model = solid_of(options, snapshots);
      EXPECT_GT(model.facets.size(), 100U);
      EXPECT_EQ(self_intersections(model.facets), 0U)
          << "leaves of " << leaf_size << " m, max error " << target_error << " m";
    }
  }
}

TEST(SelfIntersection, IsFoundWhereThereIsOne) {
  // Two tetrahedra: the tip of one is inside the other, or not.
  const auto tetrahedra = [](float apart) {
    std::vector<Facet> facets;
    for (const float x : {0.0F, apart}) {
      const std::array<MeshVertex, 4> tips{MeshVertex{.position = {x, 0, 0}},
                                           {.position = {x + 4, 0, 0}},
                                           {.position = {x, 4, 0}},
                                           {.position = {x, 0, 4}}};
      for (const auto& [a, b, c] : std::array<std::array<std::size_t, 3>, 4>{
               {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}) {
        facets.push_back(to_facet({tips[a], tips[b], tips[c]}));
      }
    }
    return facets;
  };
  EXPECT_GT(self_intersections(tetrahedra(3)), 0U);
  EXPECT_EQ(self_intersections(tetrahedra(5)), 0U);
}

TEST(SelfIntersection, IsNotInTheRobot) { expect_no_cuts(simulated_scan(robot())); }

TEST(SelfIntersection, IsNotInAThinPlate) {
  expect_no_cuts(simulated_scan(standing_block({0.07, 0.003, 0.06})));
}

TEST(SelfIntersection, IsNotInAFlatPlate) {
  expect_no_cuts(simulated_scan(standing_block({0.12, 0.09, 0.008})));
}

TEST(SelfIntersection, IsNotInAHollow) {
  const Eigen::Vector3d size(0.12, 0.1, 0.05);
  expect_no_cuts(simulated_scan(standing(hollowed_block(size, 0.035), size)));
}

TEST(SelfIntersection, IsNotInATallColumn) {
  expect_no_cuts(simulated_scan(standing_block({0.04, 0.03, 0.24})));
}

TEST(SelfIntersection, IsNotInStoredScans) {
  for (const char* const name : {"figure_scan", "tower_scan"}) {
    const std::filesystem::path folder = std::filesystem::path(OCTURN_GOLDEN) / name;
    const Scan scan = read_scan(folder);
    std::vector<Snapshot> snapshots;
    for (const Shot& shot : scan.shots) {
      snapshots.push_back(read_snapshot(folder, scan, shot));
    }
    expect_no_cuts(snapshots);
  }
}

/// A TSDF of noise; its surface from marching cubes, and after simplification.
class SelfIntersectionOfNoise : public testing::TestWithParam<std::uint32_t> {};

TEST_P(SelfIntersectionOfNoise, IsNone) {
  const std::uint32_t seed = GetParam();
  const CompactTsdf field = random_field(seed, 0.1 * (1 + seed % 9));
  const HoleFilledSdf filled(field, 3);
  const VoxelMask inside = filled.inside();
  const std::vector<Facet> all = surface_of(inside, filled);
  EXPECT_GT(all.size(), 3000U);
  EXPECT_EQ(self_intersections(all), 0U);
  for (const double target_error : {0.04, 0.1, 0.5}) {
    std::vector<Facet> facets;
    StreamSimplifier simplifier(target_error, 4, [&](std::span<const Facet> some) {
      facets.insert(facets.end(), some.begin(), some.end());
    });
    marching_cubes(inside, filled, [&](const MeshPiece& piece) { simplifier.add(piece); });
    simplifier.finish();
    EXPECT_LT(facets.size(), all.size());
    EXPECT_EQ(self_intersections(facets), 0U) << target_error << " mm";
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, SelfIntersectionOfNoise, testing::Range(1U, 19U));

}  // namespace
}  // namespace octurn
