#include "tsdf/laplace_fill.hpp"

#include <algorithm>
#include <atomic>
#include <thread>
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

// Rows of a thread in each layer: with fewer, threads wait for each other more than they work.
constexpr int min_rows = 2 * rows_at_once;

/// Relaxes rows of a layer in lexicographic order, forwards (`step` 1) or backwards (-1): those
/// from `begin` to below `end` in that order. Some rows are relaxed at once, each one value behind
/// the row before it. The values are those of a plain loop: every value is still relaxed after its
/// predecessors and before its successors.
void relax_rows(PartialGrid& grid, int z, int step, int begin, int end) {
  const auto at = [step](int i, int size) { return step > 0 ? i : size - 1 - i; };
  const Index3& size = grid.size;
  for (int first = begin; first < end; first += rows_at_once) {
    const int rows = std::min(rows_at_once, end - first);
    for (int i = 0; i < size.x + rows - 1; ++i) {
      const int last = std::min(rows, i + 1);
      for (int row = std::max(0, i - size.x + 1); row < last; ++row) {
        relax(grid, at(i - row, size.x), at(first + row, size.y), z);
      }
    }
  }
}

/// Layers that a thread has relaxed, in all sweeps together. Each in a cache line of its own.
struct alignas(64) Progress {
  std::atomic<int> layers = 0;
};

void wait_for(const Progress& progress, int layers, const std::stop_token& stop) {
  while (progress.layers.load(std::memory_order_acquire) < layers) {
    throw_if_stopped(stop);
    std::this_thread::yield();
  }
}

/// Gauss-Seidel sweeps, each forwards and then backwards. Each thread has some rows of every layer.
/// It relaxes them as soon as the thread whose rows precede them in the sweep has finished that
/// layer, so that neighbours are relaxed in the same order as by one thread.
void gauss_seidel_sweeps(PartialGrid& grid, const std::stop_token& stop, ThreadTeam& team) {
  const Index3& size = grid.size;
  const int threads = std::clamp(size.y / min_rows, 1, team.size());
  std::vector<Progress> done(static_cast<std::size_t>(threads));
  const auto work = [&](int thread) {
    const int low = size.y * thread / threads;
    const int end = size.y * (thread + 1) / threads;
    Progress& own = done[static_cast<std::size_t>(thread)];
    int layers = 0;
    for (int sweep = 0; sweep < 2 * symmetric_sweeps; ++sweep) {
      const int step = sweep % 2 == 0 ? 1 : -1;
      const int before = thread - step;
      for (int i = 0; i < size.z; ++i) {
        throw_if_stopped(stop);
        ++layers;
        if (before >= 0 && before < threads) {
          wait_for(done[static_cast<std::size_t>(before)], layers, stop);
        }
        relax_rows(grid, step > 0 ? i : size.z - 1 - i, step, step > 0 ? low : size.y - end,
                   step > 0 ? end : size.y - low);
        own.layers.store(layers, std::memory_order_release);
      }
    }
  };
  if (threads == 1) {
    work(0);
    return;
  }
  team.run([&](int thread) {
    if (thread < threads) {
      work(thread);
    }
  });
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

PartialGrid laplace_fill(PartialGrid grid, const std::stop_token& stop, ThreadTeam& team) {
  throw_if_stopped(stop);
  if (grid.values.size() < 2 || std::ranges::all_of(grid.known, [](char k) { return k != 0; })) {
    return grid;
  }
  const PartialGrid coarse = laplace_fill(restricted(grid), stop, team);
  for_each_pair(grid, coarse, [&](std::size_t to, std::size_t from) {
    if (grid.known[to] == 0) {
      grid.values[to] = coarse.values[from];
    }
  });
  gauss_seidel_sweeps(grid, stop, team);
  return grid;
}

}  // namespace octurn
