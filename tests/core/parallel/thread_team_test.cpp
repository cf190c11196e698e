#include "parallel/thread_team.hpp"

#include <gtest/gtest.h>

#include <latch>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace octurn {
namespace {

TEST(ThreadTeam, RunsEachIndexOnAThreadOfItsOwnAndTheFirstOnTheCallers) {
  ThreadTeam team(4);
  ASSERT_EQ(team.size(), 4);
  std::vector<std::thread::id> ran(4);
  std::latch all_run(4);  // no task ends before all have begun
  team.run([&](int i) {
    ran[static_cast<std::size_t>(i)] = std::this_thread::get_id();
    all_run.arrive_and_wait();
  });
  EXPECT_EQ(ran[0], std::this_thread::get_id());
  EXPECT_EQ(std::set(ran.begin(), ran.end()).size(), ran.size());
}

TEST(ThreadTeam, EndsAStepBeforeTheNextBegins) {
  ThreadTeam team(3);
  std::vector<int> steps(3);  // completed by each thread; read by the others in the next step
  for (int step = 0; step < 2000; ++step) {
    std::vector<int> seen(3);
    team.run([&](int i) {
      seen[static_cast<std::size_t>(i)] = std::accumulate(steps.begin(), steps.end(), 0);
    });
    ASSERT_EQ(seen, std::vector<int>(3, 3 * step));
    team.run([&](int i) { ++steps[static_cast<std::size_t>(i)]; });
  }
}

TEST(ThreadTeam, TakesEachItemOnce) {
  ThreadTeam team(4);
  std::vector<int> taken(1000);
  team.for_each(1000, [&](int item) { ++taken[static_cast<std::size_t>(item)]; });
  EXPECT_EQ(taken, std::vector<int>(1000, 1));
  team.for_each(0, [](int) { FAIL() << "an item of none"; });
}

TEST(ThreadTeam, SharesOutAllItems) {
  ThreadTeam team(3);
  for (const std::size_t count : {0U, 1U, 2U, 3U, 100U}) {
    std::size_t next = 0;
    for (int i = 0; i < 3; ++i) {
      const auto [first, end] = team.share(count, i);
      EXPECT_EQ(first, next);
      EXPECT_LE(end - first, count / 3 + 1);
      next = end;
    }
    EXPECT_EQ(next, count);
  }
}

TEST(ThreadTeam, ThrowsWhatTheLowestIndexThrewAndGoesOn) {
  ThreadTeam team(4);
  std::vector<int> ended(4);
  try {
    team.run([&](int i) {
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
  EXPECT_NO_THROW(team.run([](int) {}));
}

TEST(ThreadTeam, OfOneIsTheCallerAlone) {
  std::thread::id ran;
  ThreadTeam::alone().run([&](int) { ran = std::this_thread::get_id(); });
  EXPECT_EQ(ran, std::this_thread::get_id());
  EXPECT_EQ(ThreadTeam::alone().size(), 1);
  EXPECT_THROW(ThreadTeam::alone().run([](int) { throw std::runtime_error(""); }),
               std::runtime_error);
}

}  // namespace
}  // namespace octurn
