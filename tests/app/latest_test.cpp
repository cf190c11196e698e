#include "latest.hpp"

#include <gtest/gtest.h>

#include <array>
#include <thread>

#include "support/patience.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

TEST(Latest, HandsOutWhatWasSetLast) {
  Latest<int> latest;
  EXPECT_EQ(*latest.get(), 0);
  latest.set(5);
  latest.update([](int& value) { ++value; });
  EXPECT_EQ(*latest.get(), 6);
}

TEST(Latest, LeavesAReaderWhatItHas) {
  Latest<int> latest;
  const auto before = latest.get();
  latest.set(1);
  EXPECT_EQ(*before, 0);
}

TEST(Latest, WaitsForWhatIsWanted) {
  Latest<int> latest;
  const std::jthread writer([&] {
    for (int value = 1; value <= 100; ++value) {
      latest.set(value);
    }
  });
  EXPECT_EQ(*latest.wait({}, patience, [](int value) { return value == 100; }), 100);
}

TEST(Latest, StopsWaitingInTimeOrWhenAsked) {
  const Latest<int> latest;
  const auto never = [](int) { return false; };
  EXPECT_EQ(*latest.wait({}, 1ms, never), 0);
  std::stop_source stop;
  const std::jthread other([&] { stop.request_stop(); });
  latest.wait(stop.get_token(), 24h, never);  // returns at the request; else CTest times out
}

TEST(Latest, LosesNoUpdateOfSeveralWriters) {
  Latest<int> latest;
  {
    std::array<std::jthread, 4> writers;
    for (std::jthread& writer : writers) {
      writer = std::jthread([&] {
        for (int i = 0; i < 1000; ++i) {
          latest.update([](int& value) { ++value; });
        }
      });
    }
  }
  EXPECT_EQ(*latest.get(), 4000);
}

}  // namespace
}  // namespace octurn
