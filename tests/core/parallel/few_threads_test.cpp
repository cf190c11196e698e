// Threads where the system gives fewer than are asked for. Each test limits the address space of a
// process of its own, of which the address sanitizer takes terabytes: there are no such tests with
// it.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "parallel/fork_join.hpp"
#include "parallel/thread_team.hpp"

#if !defined(__has_feature)
#define __has_feature(x) 0
#endif
#if !defined(__SANITIZE_ADDRESS__) && !__has_feature(address_sanitizer)

namespace octurn {
namespace {

constexpr int wanted = 256;

/// Limits the address space to what is in use and 100 MB: room for about ten stacks.
void allow_few_threads() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  const rlimit limit{.rlim_cur = pages * 4096 + 100'000'000, .rlim_max = RLIM_INFINITY};
  if (::setrlimit(RLIMIT_AS, &limit) != 0) {
    std::_Exit(2);
  }
}

TEST(FewThreadsDeathTest, AForkRunsEachIndexOnce) {
  const auto run = [] {
    allow_few_threads();
    std::vector<std::atomic<int>> ran(wanted);
    fork_join(wanted, [&](int i) { ++ran[static_cast<std::size_t>(i)]; });
    for (const std::atomic<int>& times : ran) {
      if (times != 1) {
        std::_Exit(3);
      }
    }
    std::_Exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "");
}

TEST(FewThreadsDeathTest, ATeamIsSmallerAndDoesTheSameWork) {
  const auto run = [] {
    allow_few_threads();
    ThreadTeam team(wanted);
    std::atomic<int> sum = 0;
    team.for_each(1000, [&](int i) { sum += i; });
    std::_Exit(team.size() > 1 && team.size() < wanted && sum == 999 * 1000 / 2 ? 0 : 3);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace octurn

#endif
