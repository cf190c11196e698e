#include "mesh/self_intersections.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

namespace octurn {
namespace {

struct Mesh {
  std::vector<std::array<float, 3>> vertices = {};
  std::vector<MeshTriangle> triangles = {};
};

using Boxes = std::set<std::pair<std::array<float, 3>, std::array<float, 3>>>;

void add(const std::vector<Aabb>& found, Boxes& boxes) {
  for (const Aabb& box : found) {
    boxes.emplace(box.min, box.max);
  }
}

Boxes boxes_of(const Mesh& mesh, std::size_t already_checked = 0) {
  Boxes boxes;
  add(self_intersections(mesh.vertices, mesh.triangles, already_checked), boxes);
  return boxes;
}

/// Brute force over all pairs of triangles: the reference for the search and for the fans that it
/// skips. `are_disjoint` is tested separately, against exact predicates.
Boxes boxes_of_pairs(const Mesh& mesh, std::size_t already_checked = 0) {
  const auto box_of = [&](const MeshTriangle& triangle) {
    const auto& [a, b, c] = triangle;
    Aabb box{.min = mesh.vertices[a], .max = mesh.vertices[a]};
    box.extend({mesh.vertices[b], mesh.vertices[b]});
    box.extend({mesh.vertices[c], mesh.vertices[c]});
    return box;
  };
  Boxes boxes;
  for (std::size_t i = already_checked; i < mesh.triangles.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Aabb a = box_of(mesh.triangles[i]);
      const Aabb b = box_of(mesh.triangles[j]);
      if (a.overlaps(b) && !are_disjoint(mesh.vertices, mesh.triangles[i], mesh.triangles[j])) {
        add({a, b}, boxes);
      }
    }
  }
  return boxes;
}

/// A torus, 10 mm thick, whose vertices are moved by up to `max_shift` millimetres along each axis.
Mesh ring(std::uint32_t seed, float max_shift) {
  constexpr std::uint32_t around = 14;
  constexpr std::uint32_t across = 7;
  std::mt19937 random(seed);
  const auto moved = [&](double at) {
    // std::uniform_real_distribution would differ between standard libraries.
    return static_cast<float>(at) + max_shift * (static_cast<float>(random() % 2001) / 1000 - 1);
  };
  Mesh mesh;
  for (std::uint32_t i = 0; i < around; ++i) {
    const double turn = 2 * std::numbers::pi * i / around;
    for (std::uint32_t j = 0; j < across; ++j) {
      const double tilt = 2 * std::numbers::pi * j / across;
      const double radius = 20 + 5 * std::cos(tilt);
      mesh.vertices.push_back({moved(radius * std::cos(turn)), moved(radius * std::sin(turn)),
                               moved(5 * std::sin(tilt))});
      const auto at = [&](std::uint32_t u, std::uint32_t v) {
        return u % around * across + v % across;
      };
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// A fan of triangles around the origin between successive directions (degrees, and height at a
/// distance of 10). A closed fan is made a closed mesh by a second fan around a point below.
Mesh fan(const std::vector<std::array<double, 2>>& directions, bool is_closed) {
  Mesh mesh{.vertices = {{0, 0, 0}, {0, 0, -40}}, .triangles = {}};
  for (std::uint32_t i = 0; i < directions.size(); ++i) {
    const auto& [degrees, height] = directions[i];
    const double turn = degrees / 180 * std::numbers::pi;
    mesh.vertices.push_back({static_cast<float>(10 * std::cos(turn)),
                             static_cast<float>(10 * std::sin(turn)), static_cast<float>(height)});
    const bool is_last = i + 1 == directions.size();
    if (is_closed || !is_last) {
      mesh.triangles.push_back({0, i + 2, is_last ? 2 : i + 3});
    }
    if (is_closed) {
      mesh.triangles.push_back({1, is_last ? 2 : i + 3, i + 2});
    }
  }
  return mesh;
}

TEST(SelfIntersections, AreOfTwoTrianglesThatMeetOutsideSharedCorners) {
  const auto found = [](const MeshTriangle& other) {
    const Mesh mesh{.vertices = {{0, 0, 0},
                                 {4, 0, 0},
                                 {0, 4, 0},
                                 {3, 1, 0},
                                 {1, 1, -1},
                                 {1, 1, 1},
                                 {5, 5, -1},
                                 {5, 5, 1}},
                    .triangles = {{0, 1, 2}, other}};
    return boxes_of(mesh).size();
  };
  EXPECT_EQ(found({0, 4, 5}), 2U);  // one shared corner
  EXPECT_EQ(found({1, 6, 7}), 0U);
  EXPECT_EQ(found({0, 2, 3}), 2U);  // a shared edge
  EXPECT_EQ(found({0, 2, 4}), 0U);
  EXPECT_EQ(found({4, 5, 6}), 2U);  // nothing shared
  EXPECT_EQ(found({5, 6, 7}), 0U);
}

TEST(SelfIntersections, AreThoseOfAllPairs) {
  std::set<bool> found;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    const Mesh mesh = ring(seed, 0.8F * static_cast<float>(seed - 1));
    const Boxes boxes = boxes_of(mesh);
    EXPECT_EQ(boxes, boxes_of_pairs(mesh)) << "seed " << seed;
    EXPECT_EQ(boxes_of(mesh, 70), boxes_of_pairs(mesh, 70)) << "seed " << seed;
    found.insert(boxes.empty());
  }
  EXPECT_EQ(found.size(), 2U) << "some have intersections, some have none";
}

TEST(SelfIntersections, AreThoseOfAllPairsWhereTrianglesAreMissing) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    Mesh mesh = ring(seed, 0.5F * static_cast<float>(seed));
    std::erase_if(mesh.triangles, [random = std::mt19937(seed)](const MeshTriangle&) mutable {
      return random() % 8 == 0;
    });
    EXPECT_EQ(boxes_of(mesh), boxes_of_pairs(mesh)) << "seed " << seed;
  }
}

TEST(SelfIntersections, AreThoseOfAllPairsWhereTrianglesAreDegenerate) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    Mesh mesh = ring(seed, 0.3F * static_cast<float>(seed));
    mesh.vertices[10] = mesh.vertices[11];                    // no area
    mesh.triangles[50][0] = mesh.triangles[50][1];            // a corner twice
    mesh.triangles.push_back(mesh.triangles[seed]);           // a triangle twice
    mesh.vertices[40] = {mesh.vertices[41][0], 0.0F, 1e30F};  // a needle
    EXPECT_EQ(boxes_of(mesh), boxes_of_pairs(mesh)) << "seed " << seed;
  }
}

TEST(SelfIntersections, AreNoneInFanThatWindsOnce) {
  const Mesh mesh = fan({{0, 0}, {70, 3}, {110, -2}, {200, 0}, {290, 4}}, true);
  EXPECT_TRUE(boxes_of(mesh).empty());
  EXPECT_TRUE(boxes_of_pairs(mesh).empty());
}

TEST(SelfIntersections, AreFoundInFanThatWindsTwice) {
  std::vector<std::array<double, 2>> directions;
  for (int i = 0; i < 7; ++i) {
    directions.push_back({720.0 / 7 * i, i % 3 - 1.0});
  }
  const Mesh mesh = fan(directions, true);
  EXPECT_FALSE(boxes_of(mesh).empty());
  EXPECT_EQ(boxes_of(mesh), boxes_of_pairs(mesh));
}

TEST(SelfIntersections, AreFoundInFoldedFan) {
  const Mesh mesh = fan({{0, 0}, {100, 0}, {80, 1}, {60, -1}, {180, -2}, {270, 0}}, true);
  EXPECT_FALSE(boxes_of(mesh).empty());
  EXPECT_EQ(boxes_of(mesh), boxes_of_pairs(mesh));
}

TEST(SelfIntersections, AreFoundInOpenFanOfMoreThanOneTurn) {
  const Mesh mesh =
      fan({{0, 0}, {60, 1}, {120, 1}, {180, 1}, {240, 1}, {300, 1}, {360, 1}, {420, 0}}, false);
  EXPECT_FALSE(boxes_of(mesh).empty());
  EXPECT_EQ(boxes_of(mesh), boxes_of_pairs(mesh));
}

}  // namespace
}  // namespace octurn
