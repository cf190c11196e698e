// Compares the overlap test with CGAL's exact predicates, which share no code with Octurn. The test
// has its own file, as CGAL takes long to compile.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include "mesh/self_intersections.hpp"

namespace octurn {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Positions = std::vector<std::array<float, 3>>;

Kernel::Point_3 point(const Positions& vertices, std::uint32_t i) {
  return {static_cast<double>(vertices[i][0]), static_cast<double>(vertices[i][1]),
          static_cast<double>(vertices[i][2])};
}

Kernel::Triangle_3 triangle_of(const Positions& vertices, const MeshTriangle& t) {
  return {point(vertices, t[0]), point(vertices, t[1]), point(vertices, t[2])};
}

/// Whether two triangles, neither degenerate, meet outside their shared vertices.
bool overlap_exactly(const Positions& vertices, MeshTriangle a, MeshTriangle b) {
  const auto shared = std::stable_partition(a.begin(), a.end(), [&](std::uint32_t corner) {
    return std::ranges::find(b, corner) != b.end();
  });
  std::stable_partition(b.begin(), b.end(), [&](std::uint32_t corner) {
    return std::ranges::find(a, corner) != a.end();
  });
  const auto p = [&](std::uint32_t i) { return point(vertices, i); };
  switch (shared - a.begin()) {
    case 0:
      return CGAL::do_intersect(triangle_of(vertices, a), triangle_of(vertices, b));
    case 1:
      // Beyond the shared vertex, an intersection reaches the opposite side of one of the
      // triangles.
      return CGAL::do_intersect(Kernel::Segment_3(p(a[1]), p(a[2])), triangle_of(vertices, b)) ||
             CGAL::do_intersect(Kernel::Segment_3(p(b[1]), p(b[2])), triangle_of(vertices, a));
    case 2:
      return CGAL::coplanar(p(a[0]), p(a[1]), p(a[2]), p(b[2])) &&
             CGAL::coplanar_orientation(p(a[0]), p(a[1]), p(a[2]), p(b[2])) == CGAL::POSITIVE;
    default:
      return true;
  }
}

/// Compares random pairs of triangles on a lattice so small that most touch, fold onto or nearly
/// miss each other.
///
/// The lattice is that of single precision numbers near 300 mm, 2^-15 mm apart: no gap of a real
/// mesh is smaller. On 6 steps gaps are either 0 or above 2^-15 mm / 130, and sines 0 or above
/// 1e-4, both well above the rounding error that `are_disjoint` allows for. So it must agree
/// exactly.
void expect_exact_on_lattice(std::uint32_t shared, int pairs) {
  std::mt19937 random(shared + 1);
  std::array<int, 2> found{};
  for (int i = 0; i < pairs; ++i) {
    Positions vertices(6 - shared);
    for (std::array<float, 3>& position : vertices) {
      for (float& coordinate : position) {
        coordinate = 300 + std::ldexp(static_cast<float>(random() % 7), -15);
      }
    }
    const MeshTriangle a{0, 1, 2};
    MeshTriangle b{};
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      b[corner] = corner < shared ? corner : corner + 3 - shared;
    }
    std::rotate(b.begin(), b.begin() + random() % 3, b.end());
    if (triangle_of(vertices, a).is_degenerate() || triangle_of(vertices, b).is_degenerate()) {
      continue;
    }
    const bool expected = overlap_exactly(vertices, a, b);
    ASSERT_EQ(!are_disjoint(vertices, a, b), expected) << "pair " << i;
    ASSERT_EQ(!are_disjoint(vertices, b, a), expected) << "pair " << i;
    ++found[expected ? 1 : 0];
  }
  EXPECT_GT(found[0], pairs / 100);
  EXPECT_GT(found[1], pairs / 100);
}

TEST(ExactOverlap, IsFoundOfTrianglesThatShareNoVertex) { expect_exact_on_lattice(0, 20'000); }

TEST(ExactOverlap, IsFoundOfTrianglesThatShareAVertex) { expect_exact_on_lattice(1, 20'000); }

TEST(ExactOverlap, IsFoundOfTrianglesThatShareASide) { expect_exact_on_lattice(2, 20'000); }

TEST(ExactOverlap, IsAllThatIsFoundInAMesh) {
  std::set<bool> is_any_found;
  for (std::uint32_t seed = 0; seed < 5; ++seed) {
    // A square of 12 x 12 vertices 10 mm apart, displaced by more for each seed.
    constexpr std::uint32_t side = 12;
    std::mt19937 random(seed);
    const auto moved = [&](std::uint32_t at) {
      const float by = static_cast<float>(random() % 2001) / 1000 - 1;
      return 10 * (static_cast<float>(at) + 0.4F * static_cast<float>(seed) * by);
    };
    Positions vertices;
    std::vector<MeshTriangle> triangles;
    for (std::uint32_t y = 0; y < side; ++y) {
      for (std::uint32_t x = 0; x < side; ++x) {
        vertices.push_back({moved(x), moved(y), moved(0)});
        const std::uint32_t at = y * side + x;
        if (x + 1 < side && y + 1 < side) {
          triangles.push_back({at, at + 1, at + side + 1});
          triangles.push_back({at, at + side + 1, at + side});
        }
      }
    }
    using Boxes = std::set<std::pair<std::array<float, 3>, std::array<float, 3>>>;
    Boxes found;
    for (const Aabb& box : self_intersections(vertices, triangles, 0)) {
      found.emplace(box.min, box.max);
    }
    Boxes expected;
    for (const MeshTriangle& a : triangles) {
      const bool is_cut = std::ranges::any_of(triangles, [&](const MeshTriangle& b) {
        return a != b && overlap_exactly(vertices, a, b);
      });
      if (is_cut) {
        Aabb box{.min = vertices[a[0]], .max = vertices[a[0]]};
        box.extend({vertices[a[1]], vertices[a[1]]});
        box.extend({vertices[a[2]], vertices[a[2]]});
        expected.emplace(box.min, box.max);
      }
    }
    EXPECT_EQ(found, expected) << "seed " << seed;
    is_any_found.insert(found.empty());
  }
  EXPECT_EQ(is_any_found.size(), 2U) << "some have intersections, some have none";
}

TEST(AreDisjoint, TakesAGapBelowRoundingForContact) {
  const auto is_disjoint_with_gap = [](float gap) {
    const Positions vertices{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, gap}, {3, 1, 5}, {1, 3, 5}};
    return are_disjoint(vertices, {0, 1, 2}, {3, 4, 5});
  };
  EXPECT_FALSE(is_disjoint_with_gap(0));
  EXPECT_FALSE(is_disjoint_with_gap(0.5e-7F));
  EXPECT_TRUE(is_disjoint_with_gap(2e-7F));
}

}  // namespace
}  // namespace octurn
