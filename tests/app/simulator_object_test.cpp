#include "simulator/simulator_object.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numbers>
#include <random>
#include <set>

namespace octurn {
namespace {

using Eigen::Vector3d;

/// Volume of a closed mesh whose triangles are counter-clockwise seen from outside, m3.
double volume_of(const Mesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vector3d second = mesh.vertices[b].cast<double>();
    const Vector3d third = mesh.vertices[c].cast<double>();
    volume += mesh.vertices[a].cast<double>().dot(second.cross(third)) / 6;
  }
  return volume;
}

void expect_closed(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> balance;  // edges minus their opposites
  for (const auto& triangle : mesh.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = triangle[i];
      const std::uint32_t to = triangle[(i + 1) % 3];
      balance[std::minmax(from, to)] += from < to ? 1 : -1;
    }
  }
  for (const auto& [edge, sum] : balance) {
    ASSERT_EQ(sum, 0) << edge.first << " " << edge.second;
  }
}

/// A random point in a box.
Vector3d point_in(const Eigen::AlignedBox3d& box, std::mt19937& random) {
  std::uniform_real_distribution<double> share(0, 1);
  const double x = share(random);
  const double y = share(random);
  const double z = share(random);
  return box.min() + Vector3d(x, y, z).cwiseProduct(box.sizes());
}

TEST(SurfaceNet, MeshesASphere) {
  const auto sphere = [](const Vector3d& p) { return (p - Vector3d(0.01, 0, 0)).norm() - 0.02; };
  const Eigen::AlignedBox3d bounds(Vector3d(-0.011, -0.021, -0.021), Vector3d(0.031, 0.021, 0.021));

  const Mesh mesh = surface_net(sphere, bounds, 0.001);

  expect_closed(mesh);
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    ASSERT_NEAR(sphere(vertex.cast<double>()), 0, 1e-7);
  }
  const double volume = 4 * std::numbers::pi / 3 * 0.02 * 0.02 * 0.02;
  EXPECT_NEAR(volume_of(mesh) / volume, 1, 0.002);  // chords of 1 mm at a radius of 20
}

TEST(SimulatorObject, HasDistancesThatARayMayAdvanceBy) {
  std::mt19937 random(1);
  for (int i = 0; i < 100000; ++i) {
    const Vector3d a = point_in(simulator_object_bounds(), random);
    const Vector3d b = a + 0.01 * (point_in({Vector3d(-1, -1, -1), Vector3d(1, 1, 1)}, random));
    ASSERT_LE(std::abs(simulator_object_distance(a) - simulator_object_distance(b)),
              (a - b).norm() * (1 + 1e-9))
        << a.transpose() << " " << b.transpose();
  }
}

TEST(SimulatorObject, LiesWithinItsBounds) {
  std::mt19937 random(2);
  const Eigen::AlignedBox3d bounds = simulator_object_bounds();
  for (int i = 0; i < 100000; ++i) {
    Vector3d face = point_in(bounds, random);
    const int axis = i % 3;
    face[axis] = (i & 4) != 0 ? bounds.min()[axis] : bounds.max()[axis];
    ASSERT_GT(simulator_object_distance(face), 0) << face.transpose();
  }
}

TEST(SimulatorObject, StandsOnThePlatform) {
  const Vector3d foot(0.019, -0.004, 0);
  EXPECT_NEAR(simulator_object_distance(foot), 0, 1e-9);
  EXPECT_NEAR(simulator_object_distance(foot + Vector3d(0, 0, 0.001)), -0.001, 1e-9);
  EXPECT_GT(simulator_object_distance(Vector3d(0, 0, 0.005)), 0.004);  // between the feet
}

TEST(SimulatorObject, HasAHollowAThinFlagAndAnOverhang) {
  EXPECT_GT(simulator_object_distance(Vector3d(0, -0.015, 0.062)), 0);  // in the belly's hollow
  EXPECT_LT(simulator_object_distance(Vector3d(0, -0.008, 0.062)), 0);  // behind it
  EXPECT_NEAR(simulator_object_distance(Vector3d(0.08, -0.010, 0.146)), -0.0012, 1e-9);
  EXPECT_GT(simulator_object_distance(Vector3d(0, 0, 0.03)), 0);  // under the body
}

TEST(SimulatorObject, IsMeshedOnItsSurfaceAndClosed) {
  const Mesh mesh = simulator_object();

  expect_closed(mesh);
  std::size_t off = 0;
  for (const Eigen::Vector3f& vertex : mesh.vertices) {
    const double distance = std::abs(simulator_object_distance(vertex.cast<double>()));
    ASSERT_LT(distance, 0.0005);
    off += distance > 0.00002 ? 1U : 0U;
  }
  EXPECT_LT(off, mesh.vertices.size() / 100);  // at creases

  std::mt19937 random(3);
  int inside = 0;
  constexpr int samples = 1000000;
  for (int i = 0; i < samples; ++i) {
    inside += simulator_object_distance(point_in(simulator_object_bounds(), random)) < 0 ? 1 : 0;
  }
  const double volume = simulator_object_bounds().volume() * inside / samples;
  EXPECT_NEAR(volume_of(mesh) / volume, 1, 0.015);  // 0.3 % from sampling, 1 % from chords
}

}  // namespace
}  // namespace octurn
