#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>

#include "doctor/machine_checks.hpp"
#include "support/patience.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

constexpr WatchIntervals brisk{.disk = 1ms, .warnings = 1h};

/// Waits until `holds`, at most for `patience`. @return whether it holds
bool is_soon(const std::function<bool()>& holds) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!holds() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(1ms);
  }
  return holds();
}

TEST(MachineWatch, HasLookedBeforeItIsAsked) {
  const MachineWatch watch({.free_bytes = [] { return 5U; },
                            .warnings = [] { return std::vector<Finding>{{.check = "supply"}}; }},
                           {.disk = 1h, .warnings = 1h});
  EXPECT_EQ(watch.health()->disk_free_bytes, 5U);
  ASSERT_EQ(watch.health()->warnings.size(), 1U);
  EXPECT_EQ(watch.health()->warnings.front().check, "supply");
}

TEST(MachineWatch, SeesTheDiskFillAndReadsTheMachineLessOften) {
  std::atomic<std::uint64_t> free = 5;
  std::atomic<int> readings = 0;
  const MachineWatch watch({.free_bytes = [&] { return free.load(); },
                            .warnings =
                                [&] {
                                  ++readings;
                                  return std::vector<Finding>{};
                                }},
                           brisk);
  free = 3;
  EXPECT_TRUE(is_soon([&] { return watch.health()->disk_free_bytes == 3; }));
  EXPECT_EQ(readings, 1);
}

TEST(MachineWatch, LooksForWarningsAgain) {
  std::atomic<bool> is_hot = false;
  const MachineWatch watch({.free_bytes = [] { return 5U; },
                            .warnings =
                                [&] {
                                  return is_hot ? std::vector<Finding>{{.check = "temperature"}}
                                                : std::vector<Finding>{};
                                }},
                           {.disk = 1ms, .warnings = 1ms});
  EXPECT_TRUE(watch.health()->warnings.empty());
  is_hot = true;
  EXPECT_TRUE(is_soon([&] { return watch.health()->warnings.size() == 1; }));
}

TEST(MachineWatch, TellsTheSameObjectUntilSomethingChanges) {
  std::atomic<int> looks = 0;
  const MachineWatch watch({.free_bytes =
                                [&] {
                                  ++looks;
                                  return 5U;
                                },
                            .warnings = [] { return std::vector<Finding>{}; }},
                           brisk);
  const auto before = watch.health();
  EXPECT_TRUE(is_soon([&] { return looks > 10; }));
  EXPECT_EQ(watch.health(), before);
}

TEST(MachineWatch, KeepsWhatItKnowsWhereTheDiskDoesNotAnswer) {
  std::atomic<int> looks = 0;
  const MachineWatch watch({.free_bytes = [&]() -> std::uint64_t {
                              if (++looks > 1) {
                                throw std::runtime_error("no such folder");
                              }
                              return 5;
                            },
                            .warnings = [] { return std::vector<Finding>{}; }},
                           brisk);
  EXPECT_TRUE(is_soon([&] { return looks > 3; }));
  EXPECT_EQ(watch.health()->disk_free_bytes, 5U);
}

}  // namespace
}  // namespace octurn
