#include "mesh/surface_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace octurn {
namespace {

using Eigen::Vector3d;
using Corners = std::array<Vector3d, 3>;

TEST(SurfaceCells, HaveWhatWasAddedWithinADistance) {
  SurfaceCells cells;
  EXPECT_TRUE(cells.empty());
  cells.add(Vector3d(0.001, -0.001, 0.001));  // in the cell from (0, -4, 0) to (4, 0, 4) mm
  EXPECT_FALSE(cells.empty());
  EXPECT_TRUE(cells.has_near({0.002, -0.002, 0.002}, 0));
  EXPECT_TRUE(cells.has_near({0.0099, -0.002, 0.002}, 0.006));
  EXPECT_FALSE(cells.has_near({0.0101, -0.002, 0.002}, 0.006));
  EXPECT_TRUE(cells.has_near({0.002, 0.0049, -0.0029}, 0.006));   // 5 and 3 mm off: 5.8
  EXPECT_FALSE(cells.has_near({0.002, 0.0049, -0.0041}, 0.006));  // 5 and 4 mm off: 6.4
}

TEST(SurfaceCells, CoverALargeFacet) {
  SurfaceCells cells;
  cells.add(Corners{Vector3d(0, 0, 0.001), Vector3d(0.1, 0, 0.001), Vector3d(0, 0.1, 0.001)});
  for (double x = 0.001; x < 0.1; x += 0.003) {
    for (double y = 0.001; x + y < 0.1; y += 0.003) {
      EXPECT_TRUE(cells.has_near({x, y, 0.002}, 0.004)) << x << " " << y;
    }
  }
  EXPECT_FALSE(cells.has_near({0.08, 0.08, 0.002}, 0.004));
}

TEST(SurfaceCells, GrowCoarserWhenThereAreManyAndLoseNone) {
  std::mt19937 random(7);
  const auto next = [&] { return static_cast<double>(random()) / 4294967296.0 * 4 - 2; };
  std::vector<Vector3d> points;
  for (std::size_t i = 0; i < 3 * SurfaceCells::max_bricks; ++i) {  // each in a brick of its own
    points.emplace_back(next(), next(), next());
  }
  SurfaceCells cells;
  for (const Vector3d& point : points) {
    cells.add(point);
  }
  EXPECT_TRUE(
      std::ranges::all_of(points, [&](const Vector3d& point) { return cells.has_near(point, 0); }));
  EXPECT_FALSE(cells.has_near({3, 3, 3}, 0.1));
}

}  // namespace
}  // namespace octurn
