#include "http/guess_limit.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>

namespace octurn {
namespace {

using namespace std::chrono_literals;

const GuessLimit::Time start = GuessLimit::Time{} + 1000s;

TEST(GuessLimit, LetsTenBeWrongAndThenOneEachTenSecondsOnAverage) {
  for (const double chance : {0.0, 0.5, 1.0, 3.0}) {
    GuessLimit guesses;
    for (int i = 0; i < 10; ++i) {
      EXPECT_TRUE(guesses.allows("10.0.0.1", start)) << i;
      guesses.count_wrong("10.0.0.1", start, chance);
    }
    GuessLimit::Time next = start + std::chrono::milliseconds(static_cast<int>(chance * 10'000));
    EXPECT_FALSE(chance > 0 && guesses.allows("10.0.0.1", next - 1ms)) << chance;
    ASSERT_TRUE(guesses.allows("10.0.0.1", next)) << chance;
    guesses.count_wrong("10.0.0.1", next, 1);
    EXPECT_FALSE(guesses.allows("10.0.0.1", next + 9999ms)) << chance;
    EXPECT_TRUE(guesses.allows("10.0.0.1", next + 10s)) << chance;
  }
}

TEST(GuessLimit, ForgetsInTime) {
  GuessLimit guesses;
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("10.0.0.2", start, 1);
  }
  guesses.remember("", "10.0.0.2", start);
  EXPECT_FALSE(guesses.allows("10.0.0.2", start));
  guesses.count_wrong("10.0.0.3", start + 100s, 1);
  EXPECT_TRUE(guesses.allows("10.0.0.2", start + 100s));
}

TEST(GuessLimit, CountsANetworkOfIpv6AsOneClient) {
  GuessLimit guesses;
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("2001:db8:1:2::" + std::to_string(i), start, 1);
  }
  EXPECT_FALSE(guesses.allows("2001:db8:1:2:ffff::9", start));
  EXPECT_TRUE(guesses.allows("2001:db8:1:3::1", start));
}

TEST(GuessLimit, KeepsIpv4ApartWhereAServerListensOnBoth) {
  GuessLimit guesses;
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("::ffff:10.0.0.1", start, 1);
  }
  EXPECT_FALSE(guesses.allows("::ffff:10.0.0.1", start));
  EXPECT_TRUE(guesses.allows("::ffff:10.0.0.2", start));
}

TEST(GuessLimit, LimitsTheGuessesOfAllAddressesButLocksOutNobodyWhoKnewThePassword) {
  GuessLimit guesses;
  guesses.remember("", "10.0.0.1", start);
  for (int i = 0; i < 100; ++i) {
    EXPECT_TRUE(guesses.allows("10.0.1." + std::to_string(i), start)) << i;
    guesses.count_wrong("10.0.1." + std::to_string(i), start, 1);
  }
  EXPECT_FALSE(guesses.allows("10.0.2.1", start));
  EXPECT_TRUE(guesses.allows("10.0.0.1", start));
  EXPECT_TRUE(guesses.allows("10.0.2.1", start + 1s));
  guesses.count_wrong("10.0.0.1", start + 1s, 1);
  EXPECT_TRUE(guesses.allows("10.0.2.1", start + 1s)) << "a known one's are its own";
}

TEST(GuessLimit, RemembersWhoOwesMostOfAFlood) {
  GuessLimit guesses;
  guesses.remember("", "10.0.0.1", start);  // so that its own guesses count, and not those of all
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("10.0.0.1", start, 1);
  }
  for (int i = 0; i < 5000; ++i) {
    guesses.count_wrong("2001:db8:0:" + std::to_string(i) + "::1", start, 1);
  }
  EXPECT_FALSE(guesses.allows("10.0.0.1", start));
}

TEST(GuessLimit, KnowsTheLastThousandSessions) {
  GuessLimit guesses;
  for (int i = 0; i < 1001; ++i) {
    guesses.remember(std::to_string(i), "10.0.0.1", start + i * 1s);
  }
  EXPECT_FALSE(guesses.knows("0"));
  EXPECT_TRUE(guesses.knows("1"));
  EXPECT_TRUE(guesses.knows("1000"));
}

/// Somebody who guesses, and somebody with the right password, on a clock of their own.
class Flood {
 public:
  explicit Flood(bool is_from_many) : is_from_many_(is_from_many) {}

  /// One wrong guess. @return whether it was compared with the password
  bool guess(GuessLimit::Time now) {
    const std::string address = is_from_many_ ? "10.1.0." + std::to_string(++number_ % 250) : mine;
    if (!guesses_.allows(address, now)) {
      return false;
    }
    guesses_.count_wrong(address, now, chance_(random_));
    return true;
  }

  /// One try of the right password, at the guesser's address, or at one of its own.
  bool is_let_in(GuessLimit::Time now) const { return guesses_.allows(mine, now); }

 private:
  static constexpr const char* mine = "10.0.0.1";
  const bool is_from_many_;
  int number_ = 0;
  GuessLimit guesses_ = {};
  std::mt19937_64 random_{38};
  std::exponential_distribution<double> chance_{};
};

/// Nobody guesses faster than at the price, however the guesses are spread.
TEST(GuessLimit, IsOnAverageTheSameForEveryWayToGuess) {
  constexpr int seconds = 30'000;
  for (const bool is_from_many : {false, true}) {
    const double rate = is_from_many ? 1 : 0.1;  // a second
    const double free = is_from_many ? 100 : 10;
    for (const auto& [pause, at_once] :
         {std::pair{100ms, 1}, {1000ms, 1}, {10'000ms, 20}, {100'000ms, 200}, {600'000ms, 2000}}) {
      Flood flood(is_from_many);
      double compared = 0;
      for (auto now = start; now < start + seconds * 1s; now += pause) {
        for (int i = 0; i < at_once; ++i) {
          compared += flood.guess(now) ? 1 : 0;
        }
      }
      const double allowed = free + rate * seconds;
      EXPECT_LT(compared, allowed + 4 * std::sqrt(allowed)) << pause.count() << is_from_many;
    }
  }
}

/// Beside R guesses a second one try in 20 R gets in, so that one who tries once a second waits for
/// 20 s for each of them; beside those of many addresses for 2 s.
TEST(GuessLimit, LetsTheRightPasswordInBesideAnyFlood) {
  constexpr int tries = 30'000;
  for (const bool is_from_many : {false, true}) {
    const double rate = is_from_many ? 1 : 0.1;
    for (const int guesses : {2, 10, 30}) {  // a second
      Flood flood(is_from_many);
      std::mt19937_64 random(1);
      double admitted = 0;
      for (int i = 0; i < tries; ++i) {
        const auto second = start + i * 1s;
        const int before = std::uniform_int_distribution(1, guesses)(random);
        for (int k = 0; k < guesses; ++k) {
          flood.guess(second + k * 1s / guesses);
          if (k + 1 == before) {
            const std::chrono::milliseconds gap(1000 / guesses);
            const auto later = std::uniform_int_distribution<std::int64_t>(0, gap.count())(random);
            admitted += flood.is_let_in(second + k * 1s / guesses + later * 1ms) ? 1 : 0;
          }
        }
      }
      EXPECT_GT(admitted, 0.7 * tries * rate / (2 * guesses)) << guesses << is_from_many;
    }
  }
}

/// The guesser takes each moment that it can foresee: ten seconds after its last guess, or sooner.
TEST(GuessLimit, HasNoMomentThatAGuesserCanForesee) {
  Flood flood(false);
  auto last = start;
  int admitted = 0;
  for (auto now = start; now < start + 100'000s; now += 100ms) {
    const bool is_due = (now - start) % 1s == 500ms;
    if (now - last >= 9900ms || now - start < 2s) {
      last = flood.guess(now) ? now : last;
    } else if (is_due) {
      admitted += flood.is_let_in(now) ? 1 : 0;
    }
  }
  EXPECT_GT(admitted, 10'000);
}

}  // namespace
}  // namespace octurn
