#pragma once

#include <atomic>
#include <cstddef>

#include "parallel/fork_join.hpp"

namespace octurn {

/// Calls `work(stop)` for each stop, on several threads, in no order.
template <typename Work>
void for_each_stop(std::size_t stops, int threads, Work work) {
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int) {
    for (std::size_t stop = next++; stop < stops; stop = next++) {
      work(stop);
    }
  });
}

}  // namespace octurn
