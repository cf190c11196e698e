#include "tsdf/marching_cubes_cases.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <map>
#include <set>
#include <vector>

namespace octurn {
namespace {

Eigen::Vector3d corner_at(int corner) {
  return Eigen::Vector3d(corner & 1, corner >> 1 & 1, corner >> 2);
}

/// The two corners of an edge, the one with the lower index first.
std::pair<int, int> corners_of(CubeEdge edge) {
  const int axis = edge / 4;
  const int from = (edge & 1) << (axis + 1) % 3 | (edge >> 1 & 1) << (axis + 2) % 3;
  return {from, from | 1 << axis};
}

bool is_inside(std::size_t pattern, int corner) { return (pattern >> corner & 1) != 0; }

Eigen::Vector3d middle_of(CubeEdge edge) {
  return (corner_at(corners_of(edge).first) + corner_at(corners_of(edge).second)) / 2;
}

TEST(MarchingCubesCases, CrossEdgesWhoseEndsDifferAndNoOthers) {
  for (std::size_t pattern = 0; pattern < 256; ++pattern) {
    std::set<int> used;
    for (std::size_t i = 0; i < marching_cubes_cases[pattern].count; ++i) {
      for (const CubeEdge edge : marching_cubes_cases[pattern].triangles[i]) {
        used.insert(edge);
      }
    }
    for (int edge = 0; edge < 12; ++edge) {
      const auto [a, b] = corners_of(static_cast<CubeEdge>(edge));
      EXPECT_EQ(used.contains(edge), is_inside(pattern, a) != is_inside(pattern, b))
          << "pattern " << pattern << ", edge " << edge;
    }
  }
}

/// The directed edges of a case's triangles that no other triangle of the case shares.
std::set<std::pair<int, int>> boundary(std::size_t pattern) {
  std::set<std::pair<int, int>> open;
  for (std::size_t i = 0; i < marching_cubes_cases[pattern].count; ++i) {
    const auto& triangle = marching_cubes_cases[pattern].triangles[i];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::pair<int, int> edge{triangle[k], triangle[(k + 1) % 3]};
      if (open.erase({edge.second, edge.first}) == 0) {
        EXPECT_TRUE(open.insert(edge).second) << "pattern " << pattern;
      }
    }
  }
  return open;
}

TEST(MarchingCubesCases, MatchTheirNeighboursOnTheFaceThatTheyShare) {
  // A cube's boundary on its face x = 1 is the reverse of its neighbour's boundary on x = 0.
  const auto on_face = [](std::size_t pattern, int axis, int side) {
    std::set<std::pair<std::array<double, 2>, std::array<double, 2>>> lines;
    for (const auto& [a, b] : boundary(pattern)) {
      const Eigen::Vector3d p = middle_of(static_cast<CubeEdge>(a));
      const Eigen::Vector3d q = middle_of(static_cast<CubeEdge>(b));
      if (p[axis] == side && q[axis] == side) {
        const int u = (axis + 1) % 3;
        const int v = (axis + 2) % 3;
        std::array<double, 2> from{p[u], p[v]};
        std::array<double, 2> to{q[u], q[v]};
        if (side == 1) {
          std::swap(from, to);
        }
        lines.insert({from, to});
      }
    }
    return lines;
  };
  for (int axis = 0; axis < 3; ++axis) {
    // The signs of a face's four corners, in the same order for both sides.
    const auto face_signs = [&](std::size_t pattern, int side) {
      int signs = 0;
      for (int i = 0; i < 4; ++i) {
        const int corner = side << axis | (i & 1) << (axis + 1) % 3 | (i >> 1) << (axis + 2) % 3;
        signs |= (is_inside(pattern, corner) ? 1 : 0) << i;
      }
      return signs;
    };
    for (std::size_t below = 0; below < 256; ++below) {
      const auto expected = on_face(below, axis, 1);
      for (std::size_t above = 0; above < 256; ++above) {
        if (face_signs(below, 1) == face_signs(above, 0)) {
          ASSERT_EQ(on_face(above, axis, 0), expected) << below << " below " << above;
        }
      }
    }
  }
}

TEST(MarchingCubesCases, EndOnTheCubesFacesOnly) {
  for (std::size_t pattern = 0; pattern < 256; ++pattern) {
    for (const auto& [a, b] : boundary(pattern)) {
      const Eigen::Vector3d p = middle_of(static_cast<CubeEdge>(a));
      const Eigen::Vector3d q = middle_of(static_cast<CubeEdge>(b));
      bool shares_face = false;
      for (int axis = 0; axis < 3; ++axis) {
        shares_face = shares_face || (p[axis] == q[axis] && (p[axis] == 0 || p[axis] == 1));
      }
      EXPECT_TRUE(shares_face) << "pattern " << pattern;
    }
  }
}

TEST(MarchingCubesCases, FaceAwayFromTheirInsideCorners) {
  // A single triangle's normal points away from an inside corner, and towards an outside corner.
  for (int corner = 0; corner < 8; ++corner) {
    for (const bool inside : {true, false}) {
      const auto pattern = static_cast<std::size_t>(inside ? 1 << corner : 255 - (1 << corner));
      const CubeSurface& surface = marching_cubes_cases[pattern];
      ASSERT_EQ(surface.count, 1U);
      const auto& [a, b, c] = surface.triangles[0];
      const Eigen::Vector3d normal =
          (middle_of(b) - middle_of(a)).cross(middle_of(c) - middle_of(a));
      const double away = normal.dot(middle_of(a) - corner_at(corner));
      EXPECT_EQ(away > 0, inside) << "pattern " << pattern;
    }
  }
}

TEST(MarchingCubesCases, HaveNoTrianglesWithoutAChangeOfSign) {
  EXPECT_EQ(marching_cubes_cases[0].count, 0U);
  EXPECT_EQ(marching_cubes_cases[255].count, 0U);
}

}  // namespace
}  // namespace octurn
