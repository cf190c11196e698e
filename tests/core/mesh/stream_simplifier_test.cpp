#include "mesh/stream_simplifier.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "core/mesh/shapes.hpp"
#include "core/mesh/surface.hpp"
#include "core/tsdf/random_field.hpp"
#include "tsdf/marching_cubes.hpp"

namespace octurn {
namespace {

/// The area-weighted RMS distance of facets from a sphere around (0, 0, radius), sampled at the
/// midpoints of 16 equal parts of each facet.
double rms_from_sphere(std::span<const Facet> facets, double radius) {
  constexpr int parts = 4;
  double area = 0;
  double sum = 0;
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    const Eigen::Vector3d a = Eigen::Vector3f(corners[0].data()).cast<double>();
    const Eigen::Vector3d u = Eigen::Vector3f(corners[1].data()).cast<double>() - a;
    const Eigen::Vector3d v = Eigen::Vector3f(corners[2].data()).cast<double>() - a;
    const double part_area = u.cross(v).norm() / 2 / (parts * parts);
    const auto add = [&](double s, double t) {
      const Eigen::Vector3d point = a + s / parts * u + t / parts * v;
      const double distance = (point - Eigen::Vector3d(0, 0, radius)).norm() - radius;
      sum += part_area * distance * distance;
      area += part_area;
    };
    for (int i = 0; i < parts; ++i) {
      for (int j = 0; i + j < parts; ++j) {
        add(i + 1.0 / 3, j + 1.0 / 3);
        if (i + j + 1 < parts) {
          add(i + 2.0 / 3, j + 2.0 / 3);
        }
      }
    }
  }
  return std::sqrt(sum / area);
}

TEST(StreamSimplifier, KeepsItsTargetAsRmsDistanceFromASphere) {
  constexpr double radius = 20;
  const LayeredMesh fine = sphere(radius, 60);
  for (const double target : {0.02, 0.05, 0.15}) {
    const std::vector<Facet> facets = simplified(fine, target, 1);
    EXPECT_LT(facets.size(), fine.triangles.size() / 2);
    // The fine mesh's own chords lie up to r (1 - cos(90 deg / 60)) = 0.007 mm inside.
    EXPECT_LT(rms_from_sphere(facets, radius), target + 0.007) << target;
  }
}

TEST(StreamSimplifier, TakesFewerTrianglesForALargerTarget) {
  const LayeredMesh fine = sphere(20, 60);
  std::size_t before = fine.triangles.size();
  for (const double target : {0.01, 0.03, 0.1, 0.3}) {
    const std::size_t now = simplified(fine, target, 1).size();
    EXPECT_LT(now, before) << target;
    before = now;
  }
}

TEST(StreamSimplifier, KeepsASphereManifoldThroughSeveralWindows) {
  const LayeredMesh fine = sphere(30, 140);  // 78,000 triangles; a window has 30,000
  const std::vector<Facet> facets = simplified(fine, 0.05, 1);
  EXPECT_LT(facets.size(), fine.triangles.size() / 2);
  const Topology topology = topology_of(facets);
  EXPECT_TRUE(topology.manifold);
  EXPECT_EQ(topology.euler, 2);
}

TEST(StreamSimplifier, TurnsNoFacetOver) {
  const std::vector<Facet> facets = simplified(sphere(20, 60), 0.1, 1);
  ASSERT_GT(facets.size(), 100U);
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    const auto normal = facet.normal;
    const Eigen::Vector3f centre =
        (Eigen::Vector3f(corners[0].data()) + Eigen::Vector3f(corners[1].data()) +
         Eigen::Vector3f(corners[2].data())) /
        3;
    const Eigen::Vector3f outwards = (centre - Eigen::Vector3f(0, 0, 20)).normalized();
    EXPECT_GT(Eigen::Vector3f(normal.data()).dot(outwards), 0.5F);
  }
}

TEST(StreamSimplifier, GivesTheSameBytesForPiecesOfAnySizeInOneWindow) {
  const LayeredMesh mesh = sphere(20, 60);
  const std::vector<Facet> one_by_one = simplified(mesh, 0.05, 1);
  for (const std::size_t layers_per_piece : {2U, 3U, 7U, 100U}) {
    EXPECT_TRUE(same_bytes(simplified(mesh, 0.05, layers_per_piece), one_by_one))
        << layers_per_piece;
  }
}

TEST(StreamSimplifier, HandsOverNothingOfNothing) { EXPECT_TRUE(simplified({}, 0.05, 1).empty()); }

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
