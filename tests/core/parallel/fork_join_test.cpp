#include "parallel/fork_join.hpp"

#include <gtest/gtest.h>

#include <latch>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace octurn {
namespace {

TEST(ForkJoin, RunsEachIndexOnAThreadOfItsOwnAndTheFirstOnTheCallers) {
  constexpr int threads = 4;
  std::vector<std::thread::id> ran(threads);
  std::latch all_run(threads);  // no task ends before all have begun
  fork_join(threads, [&](int i) {
    ran[static_cast<std::size_t>(i)] = std::this_thread::get_id();
    all_run.arrive_and_wait();
  });
  EXPECT_EQ(ran[0], std::this_thread::get_id());
  EXPECT_EQ(std::set(ran.begin(), ran.end()).size(), ran.size());
}

TEST(ForkJoin, ThrowsWhatTheLowestIndexThrewAfterAllHaveEnded) {
  std::vector<int> ended(4);
  try {
    fork_join(4, [&](int i) {
      ended[static_cast<std::size_t>(i)] = 1;
      if (i % 2 == 1) {
        throw std::runtime_error(std::to_string(i));
      }
    });
    ADD_FAILURE() << "nothing was thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "1");
  }
  EXPECT_EQ(ended, std::vector<int>(4, 1));
}

}  // namespace
}  // namespace octurn
