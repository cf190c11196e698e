#pragma once

#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace octurn {

/// Runs `work(i)` for i from 0 to threads - 1, each on a thread of its own (0 on the caller's), and
/// returns when all have ended. Of several exceptions, that of the lowest i reaches the caller.
template <typename Work>
void fork_join(int threads, Work work) {
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(threads));
  const auto guarded = [&](int i) {
    try {
      work(i);
    } catch (...) {
      failures[static_cast<std::size_t>(i)] = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (int i = 1; i < threads; ++i) {
      others.emplace_back(guarded, i);
    }
    guarded(0);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) {
      std::rethrow_exception(failure);
    }
  }
}

}  // namespace octurn
