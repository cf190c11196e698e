#include "http/guess_limit.hpp"

#include <gtest/gtest.h>

#include <string>

namespace octurn {
namespace {

using namespace std::chrono_literals;

const GuessLimit::Time start = GuessLimit::Time{} + 1000s;

TEST(GuessLimit, LetsTenBeWrongAndThenOneEachTenSeconds) {
  GuessLimit guesses;
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(guesses.to_wait("10.0.0.1", start), 0s) << i;
    guesses.count_wrong("10.0.0.1", start);
  }
  EXPECT_EQ(guesses.to_wait("10.0.0.1", start), 10s);
  EXPECT_EQ(guesses.to_wait("10.0.0.1", start + 9500ms), 1s);
  EXPECT_EQ(guesses.to_wait("10.0.0.1", start + 10s), 0s);
  guesses.count_wrong("10.0.0.1", start + 10s);
  EXPECT_EQ(guesses.to_wait("10.0.0.1", start + 10s), 10s);
}

TEST(GuessLimit, ForgetsInTime) {
  GuessLimit guesses;
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("10.0.0.2", start);
  }
  guesses.remember("", "10.0.0.2", start);
  EXPECT_EQ(guesses.to_wait("10.0.0.2", start), 10s);
  guesses.count_wrong("10.0.0.3", start + 100s);
  EXPECT_EQ(guesses.to_wait("10.0.0.2", start + 100s), 0s);
}

TEST(GuessLimit, CountsANetworkOfIpv6AsOneClient) {
  GuessLimit guesses;
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("2001:db8:1:2::" + std::to_string(i), start);
  }
  EXPECT_EQ(guesses.to_wait("2001:db8:1:2:ffff::9", start), 10s);
  EXPECT_EQ(guesses.to_wait("2001:db8:1:3::1", start), 0s);
}

TEST(GuessLimit, KeepsIpv4ApartWhereAServerListensOnBoth) {
  GuessLimit guesses;
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("::ffff:10.0.0.1", start);
  }
  EXPECT_EQ(guesses.to_wait("::ffff:10.0.0.1", start), 10s);
  EXPECT_EQ(guesses.to_wait("::ffff:10.0.0.2", start), 0s);
}

TEST(GuessLimit, LimitsTheGuessesOfAllAddressesButLocksOutNobodyWhoKnewThePassword) {
  GuessLimit guesses;
  guesses.remember("", "10.0.0.1", start);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(guesses.to_wait("10.0.1." + std::to_string(i), start), 0s) << i;
    guesses.count_wrong("10.0.1." + std::to_string(i), start);
  }
  EXPECT_EQ(guesses.to_wait("10.0.2.1", start), 1s);
  EXPECT_EQ(guesses.to_wait("10.0.0.1", start), 0s);
  EXPECT_EQ(guesses.to_wait("10.0.2.1", start + 1s), 0s);
  guesses.count_wrong("10.0.0.1", start + 1s);
  EXPECT_EQ(guesses.to_wait("10.0.2.1", start + 1s), 0s) << "a known one's are its own";
}

TEST(GuessLimit, RemembersWhoOwesMostOfAFlood) {
  GuessLimit guesses;
  guesses.remember("", "10.0.0.1", start);  // so that its own guesses count, and not those of all
  for (int i = 0; i < 10; ++i) {
    guesses.count_wrong("10.0.0.1", start);
  }
  for (int i = 0; i < 5000; ++i) {
    guesses.count_wrong("2001:db8:0:" + std::to_string(i) + "::1", start);
  }
  EXPECT_EQ(guesses.to_wait("10.0.0.1", start), 10s);
}

}  // namespace
}  // namespace octurn
