#include "turntable/real_time.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

namespace octurn {
namespace {

cpu_set_t set_of(std::initializer_list<std::size_t> cores) {
  cpu_set_t set = {};
  for (const std::size_t core : cores) {
    CPU_SET(core, &set);
  }
  return set;
}

TEST(CoreOfPulses, IsTheLastOfFour) {
  EXPECT_EQ(core_of_pulses(set_of({0, 1, 2, 3})), 3U);
  EXPECT_EQ(core_of_pulses(set_of({1, 4, 6, 9})), 9U);
  EXPECT_EQ(core_of_pulses(set_of({0, 1, 2})), std::nullopt);
}

TEST(OtherCores, AreGivenBack) {
  cpu_set_t before = {};
  ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
  {
    const OtherCores others;
    cpu_set_t meanwhile = {};
    ASSERT_EQ(::sched_getaffinity(0, sizeof meanwhile, &meanwhile), 0);
    const auto core = core_of_pulses(before);
    EXPECT_EQ(CPU_COUNT(&meanwhile), CPU_COUNT(&before) - (core ? 1 : 0));
    EXPECT_TRUE(!core || !CPU_ISSET(*core, &meanwhile));
  }
  cpu_set_t after = {};
  ASSERT_EQ(::sched_getaffinity(0, sizeof after, &after), 0);
  EXPECT_TRUE(CPU_EQUAL(&before, &after));
}

}  // namespace
}  // namespace octurn
