#include "mesh/qem_simplify.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>
#include <set>
#include <vector>

#include "core/mesh/shapes.hpp"

namespace octurn {
namespace {

struct WeightedPlane {
  Eigen::Hyperplane<double, 3> plane;
  double area = 0;
};

/// Random planes some 10 mm from the origin.
std::vector<WeightedPlane> random_planes(std::uint32_t seed, int count) {
  std::mt19937 random(seed);
  const auto next = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
  std::vector<WeightedPlane> planes;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d normal = Eigen::Vector3d(next(), next(), next() + 1.5).normalized();
    planes.push_back({.plane = {normal, 10 * next()}, .area = 1.5 + next()});
  }
  return planes;
}

Quadric sum_of(const std::vector<WeightedPlane>& planes) {
  Quadric sum;
  for (const auto& [plane, area] : planes) {
    const Eigen::Vector3d normal = plane.normal();
    sum += plane_quadric({normal.x(), normal.y(), normal.z()}, plane.offset(), area);
  }
  return sum;
}

double mean_square_of(const std::vector<WeightedPlane>& planes, const Eigen::Vector3d& p) {
  double sum = 0;
  double total = 0;
  for (const auto& [plane, area] : planes) {
    sum += area * plane.signedDistance(p) * plane.signedDistance(p);
    total += area;
  }
  return sum / total;
}

IndexedMesh indexed(const LayeredMesh& shape) {
  IndexedMesh mesh{.vertices = shape.vertices,
                   .quadrics = std::vector<Quadric>(shape.vertices.size()),
                   .triangles = shape.triangles};
  add_plane_quadrics(mesh, 0);
  return mesh;
}

double mean_square_at(const IndexedMesh& mesh, std::uint32_t vertex) {
  return mesh.quadrics[vertex].mean_square(to_vector3(mesh.vertices[vertex].position));
}

std::set<std::uint32_t> used_vertices(const IndexedMesh& mesh) {
  std::set<std::uint32_t> used;
  for (const MeshTriangle& triangle : mesh.triangles) {
    used.insert(triangle.begin(), triangle.end());
  }
  return used;
}

TEST(Quadric, IsTheMeanSquareDistanceFromItsPlanes) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const std::vector<WeightedPlane> planes = random_planes(seed, 6);
    const Quadric quadric = sum_of(planes);
    for (const Eigen::Vector3d& p :
         {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, -4, 5), Eigen::Vector3d(-20, 7, 11)}) {
      const double expected = mean_square_of(planes, p);
      EXPECT_NEAR(quadric.mean_square({p.x(), p.y(), p.z()}), expected, 1e-10 * (1 + expected));
    }
  }
}

TEST(Quadric, HasItsOptimumWhereNoPointBesideIsBetter) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const std::vector<WeightedPlane> planes = random_planes(seed, 6);
    const Vector3 guess{1, 2, 3};
    // The minimised cost: mean square distance to the planes, plus a thousandth of the squared
    // distance to the guess.
    const auto cost = [&](const Eigen::Vector3d& p) {
      return mean_square_of(planes, p) + 1e-3 * (p - Eigen::Vector3d(1, 2, 3)).squaredNorm();
    };
    const auto expect_best = [&](const Vector3& found, int axes) {
      const Eigen::Vector3d best(found[0], found[1], found[2]);
      for (int axis = 0; axis < axes; ++axis) {
        for (const double step : {-0.01, 0.01}) {
          EXPECT_LT(cost(best), cost(best + step * Eigen::Vector3d::Unit(axis)));
        }
      }
    };
    expect_best(sum_of(planes).optimum(guess), 3);
    const Vector3 standing = sum_of(planes).optimum_on_platform(guess);
    expect_best(standing, 2);
    EXPECT_EQ(standing[2], 0);
  }
}

TEST(Quadric, HasTheGuessAsItsOptimumAlongWhatPlanesLeaveFree) {
  const Quadric quadric = plane_quadric({0, 0, 1}, -5, 2);
  const Vector3 optimum = quadric.optimum({7, 8, 5});
  EXPECT_NEAR(optimum[0], 7, 1e-9);
  EXPECT_NEAR(optimum[1], 8, 1e-9);
  EXPECT_NEAR(optimum[2], 5, 1e-9);
}

TEST(QemSimplify, MovesNoVertexFartherFromItsPlanesThanTheTarget) {
  for (const double target : {0.01, 0.05, 0.3}) {
    IndexedMesh mesh = indexed(sphere(20, 40));
    const std::size_t before = mesh.triangles.size();
    const std::vector<char> locked(mesh.vertices.size(), 0);
    qem_simplify(mesh, locked, {.target_error = target});
    EXPECT_LT(mesh.triangles.size(), before);
    EXPECT_GT(mesh.triangles.size(), 20U);
    for (const std::uint32_t vertex : used_vertices(mesh)) {
      EXPECT_LE(mean_square_at(mesh, vertex), target * target);
    }
  }
}

TEST(QemSimplify, LosesNoPlane) {
  IndexedMesh mesh = indexed(sphere(20, 40));
  const auto total_area = [&] {
    double total = 0;
    for (const std::uint32_t vertex : used_vertices(mesh)) {
      total += mesh.quadrics[vertex].area;
    }
    return total;
  };
  const double before = total_area();
  qem_simplify(mesh, std::vector<char>(mesh.vertices.size(), 0), {.target_error = 0.1});
  EXPECT_NEAR(total_area(), before, 1e-9 * before);
  // Each plane is counted at its three corners. The mesh's area is smaller than the sphere's, as
  // its edges are chords.
  EXPECT_NEAR(before, 3 * 4 * std::numbers::pi * 400, 0.005 * before);
}

TEST(QemSimplify, MovesNoLockedVertex) {
  IndexedMesh mesh = indexed(sphere(20, 40));
  std::vector<char> locked(mesh.vertices.size(), 0);
  for (std::size_t i = 0; i < locked.size(); i += 5) {
    locked[i] = 1;
  }
  const IndexedMesh before = mesh;
  qem_simplify(mesh, locked, {.target_error = 0.5});
  EXPECT_LT(mesh.triangles.size(), before.triangles.size());
  const std::set<std::uint32_t> used = used_vertices(mesh);
  for (std::uint32_t i = 0; i < locked.size(); i += 5) {
    EXPECT_TRUE(used.contains(i));
    EXPECT_EQ(mesh.vertices[i].position, before.vertices[i].position);
  }
}

TEST(QemSimplify, LeavesNothingOutsideOfItsHeights) {
  IndexedMesh mesh = indexed(sphere(20, 40));
  const IndexedMesh before = mesh;
  qem_simplify(mesh, std::vector<char>(mesh.vertices.size(), 0),
               {.target_error = 0.5, .min_z = 10, .max_z = 25});
  EXPECT_LT(mesh.triangles.size(), before.triangles.size());
  for (const std::uint32_t vertex : used_vertices(mesh)) {
    const float z = mesh.vertices[vertex].position[2];
    const bool is_inside = z >= 10 && z <= 25;
    EXPECT_TRUE(is_inside || mesh.vertices[vertex].position == before.vertices[vertex].position);
  }
}

/// Counts a mesh's triangles after a simplification that may collapse the edge 0-1 only, as all
/// other vertices are locked, and whose target error refuses nothing.
std::size_t triangles_after_first_edge(std::vector<MeshVertex> vertices,
                                       std::vector<MeshTriangle> triangles) {
  IndexedMesh mesh =
      indexed({.vertices = std::move(vertices), .triangles = std::move(triangles), .layers = {}});
  std::vector<char> locked(mesh.vertices.size(), 1);
  locked[0] = 0;
  locked[1] = 0;
  qem_simplify(mesh, locked, {.target_error = 1000});
  return mesh.triangles.size();
}

TEST(QemSimplify, TurnsNoTriangleOver) {
  // All vertices lie in a plane. If vertex 2 is near, the middle of edge 0-1 lies beyond line 2-3.
  const auto triangles_after = [](float x, float y) {
    return triangles_after_first_edge({{.position = {0, 0, 1}},
                                       {.position = {4, 0, 1}},
                                       {.position = {x, y, 1}},
                                       {.position = {0, 3, 1}},
                                       {.position = {-3, 0, 1}},
                                       {.position = {0, -3, 1}},
                                       {.position = {x, -y, 1}},
                                       {.position = {5, -3, 1}},
                                       {.position = {5, 3, 1}}},
                                      {{0, 1, 2},
                                       {0, 2, 3},
                                       {0, 3, 4},
                                       {0, 4, 5},
                                       {0, 5, 6},
                                       {0, 6, 1},
                                       {1, 6, 7},
                                       {1, 7, 8},
                                       {1, 8, 2}});
  };
  EXPECT_EQ(triangles_after(2, 2), 7U);
  EXPECT_EQ(triangles_after(1, 0.3F), 9U);
}

TEST(QemSimplify, CollapsesNoEdgeWhoseEndsHaveAThirdNeighbourInCommon) {
  // A spike stands on triangle 0, 1, 2 of a plane. Collapsing edge 0-1 would make two of its sides
  // coincide.
  const std::vector<MeshVertex> vertices{{.position = {-1, 0, 1}},    {.position = {1, 0, 1}},
                                         {.position = {0, 1.73F, 1}}, {.position = {0, 0.58F, 21}},
                                         {.position = {0, -4, 1}},    {.position = {5, 2, 1}},
                                         {.position = {0, 6, 1}},     {.position = {-5, 2, 1}}};
  const std::vector<MeshTriangle> spike{{0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {2, 5, 6}, {2, 6, 7},
                                        {0, 2, 7}, {0, 7, 4}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_EQ(triangles_after_first_edge(vertices, spike), spike.size());
}

TEST(QemSimplify, LeavesEdgesBetweenTrianglesWithoutArea) {
  // A closed needle: all vertices lie on one line, so that no plane determines a vertex's position.
  IndexedMesh mesh{.vertices = {}, .quadrics = std::vector<Quadric>(8), .triangles = {}};
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back({.position = {static_cast<float>(i), 0, 1}});
  }
  for (std::uint32_t i = 0; i < 6; ++i) {
    const std::uint32_t next = (i + 1) % 6;
    mesh.triangles.push_back({6, i, next});
    mesh.triangles.push_back({7, next, i});
  }
  add_plane_quadrics(mesh, 0);
  const std::vector<MeshTriangle> before = mesh.triangles;
  qem_simplify(mesh, std::vector<char>(8, 0), {.target_error = 1});
  EXPECT_EQ(mesh.triangles, before);
}

TEST(Compact, KeepsUsedVerticesInOrder) {
  IndexedMesh mesh{.vertices = {{.position = {0, 0, 0}},
                                {.position = {1, 0, 0}},
                                {.position = {2, 0, 0}},
                                {.position = {3, 0, 0}},
                                {.position = {4, 0, 0}}},
                   .quadrics = std::vector<Quadric>(5),
                   .triangles = {{4, 1, 3}}};
  mesh.quadrics[3].area = 3;
  const std::vector<std::uint32_t> new_index = compact(mesh, std::array<std::uint32_t, 1>{0});
  EXPECT_EQ(new_index, (std::vector<std::uint32_t>{0, 1, removed_vertex, 2, 3}));
  EXPECT_EQ(mesh.triangles, (std::vector<MeshTriangle>{{3, 1, 2}}));
  EXPECT_EQ(mesh.vertices.size(), 4U);
  EXPECT_EQ(mesh.vertices[2].position[0], 3);
  EXPECT_EQ(mesh.quadrics[2].area, 3);
}

}  // namespace
}  // namespace octurn
