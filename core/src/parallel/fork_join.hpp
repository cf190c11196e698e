#pragma once

#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace octurn {

/// Runs `work(i)` for i from 0 to threads - 1, each on a thread of its own (0 on the caller's), and
/// returns when all have ended. Where the system gives fewer threads, the caller does the rest of
/// the work afterwards, so none may wait for another. Of several exceptions, that of the lowest i
/// reaches the caller.
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
  int begun = 1;
  {
    std::vector<std::jthread> others;
    others.reserve(failures.size());
    try {
      for (; begun < threads; ++begun) {
        others.emplace_back(guarded, begun);
      }
    } catch (const std::system_error&) {
      // the system's limit of threads, such as that of a service
    }
    guarded(0);
  }
  for (; begun < threads; ++begun) {
    guarded(begun);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) {
      std::rethrow_exception(failure);
    }
  }
}

}  // namespace octurn
