#include "parallel/ordered_pipeline.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <latch>
#include <stdexcept>
#include <thread>
#include <vector>

#include "parallel/fork_join.hpp"

namespace octurn {
namespace {

using Source = std::function<std::optional<int>()>;

/// The numbers from 0 up to, but not including, `end`.
Source numbers(int end) {
  return [next = 0, end]() mutable { return next < end ? std::optional(next++) : std::nullopt; };
}

std::vector<int> first_numbers(int end) {
  std::vector<int> expected;
  for (int i = 0; i < end; ++i) {
    expected.push_back(i);
  }
  return expected;
}

TEST(OrderedPipeline, UsesResultsInTheOrderOfTheirPiecesWhateverTheThreads) {
  for (const int threads : {1, 2, 8}) {
    for (const int window : {1, 2, 16}) {
      OrderedPipeline<Source, int> pipeline(numbers(200), window);
      std::vector<int> used;
      fork_join(threads, [&](int) {
        pipeline.run(
            [](int piece, int& result) {
              for (int i = piece % 7; i > 0; --i) {
                std::this_thread::yield();  // so that threads overtake each other
              }
              result = piece;
            },
            [&](int result) { used.push_back(result); });
      });
      EXPECT_EQ(used, first_numbers(200)) << threads << " threads, window " << window;
    }
  }
}

TEST(OrderedPipeline, GoesOnWithOtherPiecesWhileOneIsSlow) {
  // The first piece ends only after all others of the window are made. If a thread waited until its
  // piece is consumed, this would be a deadlock.
  constexpr int window = 4;
  OrderedPipeline<Source, int> pipeline(numbers(window), window);
  std::latch others(window - 1);
  std::vector<int> used;
  fork_join(2, [&](int) {
    pipeline.run(
        [&](int piece, int& result) {
          result = piece;
          if (piece == 0) {
            others.wait();
          } else {
            others.count_down();
          }
        },
        [&](int result) { used.push_back(result); });
  });
  EXPECT_EQ(used, first_numbers(window));
}

TEST(OrderedPipeline, HoldsNoMorePiecesThanItsWindow) {
  constexpr int window = 3;
  std::atomic<int> held = 0;
  std::atomic<int> most = 0;
  OrderedPipeline<Source, int> pipeline(
      [next = 0, &held, &most]() mutable -> std::optional<int> {
        if (next == 100) {
          return std::nullopt;
        }
        most = std::max(most.load(), ++held);
        return next++;
      },
      window);
  fork_join(8, [&](int) {
    pipeline.run([](int piece, int& result) { result = piece; }, [&](int) { --held; });
  });
  // A piece is consumed just before its place in the window becomes free.
  EXPECT_LE(most, window);
  EXPECT_EQ(held, 0);
}

TEST(OrderedPipeline, EndsOnAllThreadsWhenOneThrows) {
  for (const bool while_made : {true, false}) {
    OrderedPipeline<Source, int> pipeline(numbers(1'000'000), 4);
    const auto fail_at = [](int at) {
      if (at == 50) {
        throw std::runtime_error("50");
      }
    };
    std::vector<int> used;
    EXPECT_THROW(fork_join(4,
                           [&](int) {
                             pipeline.run(
                                 [&](int piece, int& result) {
                                   if (while_made) {
                                     fail_at(piece);
                                   }
                                   result = piece;
                                 },
                                 [&](int result) {
                                   if (!while_made) {
                                     fail_at(result);
                                   }
                                   used.push_back(result);
                                 });
                           }),
                 std::runtime_error);
    EXPECT_LE(used.size(), 50U);  // none after the failed piece
  }
}

}  // namespace
}  // namespace octurn
