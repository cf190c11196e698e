#include "tsdf/laplace_fill.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace octurn {
namespace {

/// A grid of unknown values, all 0.
PartialGrid empty_grid(const Index3& size) {
  PartialGrid grid{.size = size, .values = {}, .known = {}};
  grid.values.resize(grid.index(0, 0, size.z));
  grid.known.resize(grid.index(0, 0, size.z));
  return grid;
}

template <typename Visit>
void for_each(const Index3& size, Visit visit) {
  for (int z = 0; z < size.z; ++z) {
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) {
        visit(x, y, z);
      }
    }
  }
}

void set(PartialGrid& grid, int x, int y, int z, float value) {
  grid.values[grid.index(x, y, z)] = value;
  grid.known[grid.index(x, y, z)] = 1;
}

/// The mean of the six neighbours; a neighbour beyond the grid's sides has the value itself.
float mean_of_neighbours(const PartialGrid& grid, int x, int y, int z) {
  const auto clamped = [&](int i, int j, int k) {
    return grid
        .values[grid.index(std::clamp(i, 0, grid.size.x - 1), std::clamp(j, 0, grid.size.y - 1),
                           std::clamp(k, 0, grid.size.z - 1))];
  };
  return (clamped(x - 1, y, z) + clamped(x + 1, y, z) + clamped(x, y - 1, z) +
          clamped(x, y + 1, z) + clamped(x, y, z - 1) + clamped(x, y, z + 1)) /
         6;
}

/// The greatest difference between an unknown value and the mean of its neighbours.
float residual(const PartialGrid& grid) {
  float greatest = 0;
  for_each(grid.size, [&](int x, int y, int z) {
    const std::size_t i = grid.index(x, y, z);
    if (grid.known[i] == 0) {
      greatest = std::max(greatest, std::abs(mean_of_neighbours(grid, x, y, z) - grid.values[i]));
    }
  });
  return greatest;
}

/// A grid whose sides hold the function's values and whose inside is unknown.
template <typename Function>
PartialGrid boundary_of(const Index3& size, Function function) {
  PartialGrid grid = empty_grid(size);
  for_each(size, [&](int x, int y, int z) {
    if (x == 0 || y == 0 || z == 0 || x == size.x - 1 || y == size.y - 1 || z == size.z - 1) {
      set(grid, x, y, z, function(x, y, z));
    }
  });
  return grid;
}

TEST(LaplaceFill, ContinuesLinearAndQuadraticHarmonicFunctions) {
  // Both functions are harmonic, also in finite differences: the exact fill is known.
  const auto linear = [](int x, int y, int z) { return static_cast<float>(3 * x - 2 * y + z); };
  const auto saddle = [](int x, int y, int z) {
    return static_cast<float>(x * x - y * y + 2 * x * z);
  };
  const auto expect_continued = [](auto function) {
    const Index3 size{9, 7, 8};
    const PartialGrid filled = laplace_fill(boundary_of(size, function));
    float range = 0;
    for_each(size,
             [&](int x, int y, int z) { range = std::max(range, std::abs(function(x, y, z))); });
    for_each(size, [&](int x, int y, int z) {
      // Ten symmetric sweeps are twenty Gauss-Seidel sweeps. Each reduces the error by the square
      // of Jacobi's spectral radius, (cos(pi/8) + cos(pi/6) + cos(pi/7)) / 3 = 0.897; together by
      // 0.805^20 = 0.013, from an initial guess within the range.
      EXPECT_NEAR(filled.values[filled.index(x, y, z)], function(x, y, z), 0.013F * range)
          << x << " " << y << " " << z;
    });
  };
  expect_continued(linear);
  expect_continued(saddle);
}

TEST(LaplaceFill, MakesEveryUnknownValueTheMeanOfItsNeighbours) {
  std::mt19937 random(5);
  for (const Index3 size : {Index3{16, 12, 9}, Index3{5, 24, 7}, Index3{1, 6, 30}}) {
    PartialGrid grid = empty_grid(size);
    for_each(size, [&](int x, int y, int z) {
      if (random() % 8 == 0) {
        set(grid, x, y, z, static_cast<float>(random() % 2001) - 1000);
      }
    });
    ASSERT_GT(residual(grid), 100);
    const PartialGrid filled = laplace_fill(grid);
    // A hundredth of the known values' range.
    EXPECT_LT(residual(filled), 10);
    for_each(size, [&](int x, int y, int z) {
      const std::size_t i = grid.index(x, y, z);
      if (grid.known[i] != 0) {
        EXPECT_EQ(filled.values[i], grid.values[i]);
      }
      EXPECT_LE(std::abs(filled.values[i]), 1000) << "the maximum principle";
    });
  }
}

TEST(LaplaceFill, ReachesFarFromTheOnlyKnownValue) {
  PartialGrid grid = empty_grid({20, 33, 40});
  set(grid, 3, 30, 1, -7);
  for (const float value : laplace_fill(grid).values) {
    EXPECT_EQ(value, -7);
  }
}

TEST(LaplaceFill, KeepsAThinShellClosed) {
  // A spherical shell, one value thick, is negative; around it values are known to be positive. No
  // value inside may turn positive, although the shell has few values.
  const Index3 size{32, 32, 32};
  PartialGrid grid = empty_grid(size);
  for_each(size, [&](int x, int y, int z) {
    const double radius = std::hypot(x - 15.5, y - 15.5, z - 15.5);
    if (radius > 11.5) {
      set(grid, x, y, z, 1);
    } else if (radius > 10) {
      set(grid, x, y, z, -1);
    }
  });
  const PartialGrid filled = laplace_fill(grid);
  for_each(size, [&](int x, int y, int z) {
    if (std::hypot(x - 15.5, y - 15.5, z - 15.5) < 10) {
      EXPECT_LT(filled.values[filled.index(x, y, z)], 0);
    }
  });
}

TEST(LaplaceFill, LeavesAGridWithoutKnownValuesAsItIs) {
  const PartialGrid grid = empty_grid({4, 3, 5});
  EXPECT_EQ(laplace_fill(grid).values, grid.values);
  EXPECT_TRUE(laplace_fill(PartialGrid{}).values.empty());
}

}  // namespace
}  // namespace octurn
