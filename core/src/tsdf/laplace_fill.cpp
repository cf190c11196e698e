#include "tsdf/laplace_fill.hpp"

#include <algorithm>
#include <utility>

#include "octurn/snapshot.hpp"

namespace octurn {
namespace {

constexpr int symmetric_sweeps = 10;

/// Makes an unknown value the mean of its neighbours.
void relax(PartialGrid& grid, int x, int y, int z) {
  const std::size_t i = grid.index(x, y, z);
  if (grid.known[i] != 0) {
    return;
  }
  const Index3& size = grid.size;
  std::vector<float>& values = grid.values;
  const float sum = values[x > 0 ? i - 1 : i] + values[x + 1 < size.x ? i + 1 : i] +
                    values[y > 0 ? grid.index(x, y - 1, z) : i] +
                    values[y + 1 < size.y ? grid.index(x, y + 1, z) : i] +
                    values[z > 0 ? grid.index(x, y, z - 1) : i] +
                    values[z + 1 < size.z ? grid.index(x, y, z + 1) : i];
  values[i] = sum / 6;
}

// Each value waits for the one before it: a row at a time would leave the processor idle.
constexpr int rows_at_once = 4;

/// Relaxes a layer in lexicographic order, forwards (`step` 1) or backwards (-1). Some rows are
/// relaxed at once, each one value behind the row before it. The values are those of a plain loop:
/// every value is still relaxed after its predecessors and before its successors.
void relax_layer(PartialGrid& grid, int z, int step) {
  const auto at = [step](int i, int size) { return step > 0 ? i : size - 1 - i; };
  const Index3& size = grid.size;
  for (int first = 0; first < size.y; first += rows_at_once) {
    const int rows = std::min(rows_at_once, size.y - first);
    for (int i = 0; i < size.x + rows - 1; ++i) {
      const int end = std::min(rows, i + 1);
      for (int row = std::max(0, i - size.x + 1); row < end; ++row) {
        relax(grid, at(i - row, size.x), at(first + row, size.y), z);
      }
    }
  }
}

/// One Gauss-Seidel sweep forwards and one backwards.
void gauss_seidel_sweep(PartialGrid& grid, const std::stop_token& stop) {
  for (int z = 0; z < grid.size.z; ++z) {
    throw_if_stopped(stop);
    relax_layer(grid, z, 1);
  }
  for (int z = grid.size.z - 1; z >= 0; --z) {
    throw_if_stopped(stop);
    relax_layer(grid, z, -1);
  }
}

/// Calls `visit(index in fine, index in coarse)` for each fine value.
template <typename Visit>
void for_each_pair(const PartialGrid& fine, const PartialGrid& coarse, Visit visit) {
  std::size_t index = 0;
  for (int z = 0; z < fine.size.z; ++z) {
    for (int y = 0; y < fine.size.y; ++y) {
      for (int x = 0; x < fine.size.x; ++x, ++index) {
        visit(index, coarse.index(x / 2, y / 2, z / 2));
      }
    }
  }
}

/// The grid of half as many values along each axis.
PartialGrid restricted(const PartialGrid& fine) {
  PartialGrid coarse{.size = {(fine.size.x + 1) / 2, (fine.size.y + 1) / 2, (fine.size.z + 1) / 2},
                     .values = {},
                     .known = {}};
  const auto count = coarse.index(0, 0, coarse.size.z);
  coarse.values.resize(count);
  coarse.known.resize(count);
  for_each_pair(fine, coarse, [&](std::size_t from, std::size_t to) {
    if (fine.known[from] != 0) {
      const float value = fine.values[from];
      coarse.values[to] = coarse.known[to] != 0 ? std::min(coarse.values[to], value) : value;
      coarse.known[to] = 1;
    }
  });
  return coarse;
}

}  // namespace

PartialGrid laplace_fill(PartialGrid grid, const std::stop_token& stop) {
  throw_if_stopped(stop);
  if (grid.values.size() < 2 || std::ranges::all_of(grid.known, [](char k) { return k != 0; })) {
    return grid;
  }
  const PartialGrid coarse = laplace_fill(restricted(grid), stop);
  for_each_pair(grid, coarse, [&](std::size_t to, std::size_t from) {
    if (grid.known[to] == 0) {
      grid.values[to] = coarse.values[from];
    }
  });
  for (int sweep = 0; sweep < symmetric_sweeps; ++sweep) {
    gauss_seidel_sweep(grid, stop);
  }
  return grid;
}

}  // namespace octurn
