#pragma once

#include <gtest/gtest.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <functional>

namespace octurn {

/// Runs `action`, which must not throw, on a thread with civetweb's stack size. Deeper recursion
/// crashes the test program. Some processors have a larger minimum stack size.
inline void run_on_small_stack(std::function<void()> action) {
  const auto stack_bytes =
      std::max(std::size_t{102'400}, static_cast<std::size_t>(::sysconf(_SC_THREAD_STACK_MIN)));
  pthread_attr_t attributes;
  ASSERT_EQ(::pthread_attr_init(&attributes), 0);
  ASSERT_EQ(::pthread_attr_setstacksize(&attributes, stack_bytes), 0);
  pthread_t thread{};
  const auto run = [](void* given) -> void* {
    (*static_cast<std::function<void()>*>(given))();
    return nullptr;
  };
  ASSERT_EQ(::pthread_create(&thread, &attributes, run, &action), 0);
  EXPECT_EQ(::pthread_join(thread, nullptr), 0);
  ::pthread_attr_destroy(&attributes);
}

}  // namespace octurn
