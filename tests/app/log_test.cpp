#include "log.hpp"

#include <gtest/gtest.h>

#include "log_ring.hpp"

namespace octurn {
namespace {

TEST(LogRing, AreTheLastOnes) {
  LogRing lines(3, 100);
  EXPECT_EQ(lines.text(), "");
  for (const char* const line : {"one", "two", "three", "four", "five"}) {
    lines.add(line);
  }
  EXPECT_EQ(lines.text(), "three\nfour\nfive\n");
}

TEST(LogRing, AreCutWhereTheyAreTooLong) {
  LogRing lines(2, 4);
  lines.add("1234");
  lines.add("12345");
  EXPECT_EQ(lines.text(), "1234\n1234\n");
}

TEST(Log, KeepsWhatWasSaidWithItsTime) {
  log::warning("test", "first");
  log::info("test", "second");
  const std::string text = log::recent();
  const std::size_t first = text.find("Z <4>test: first\n");
  const std::size_t second = text.find("Z <6>test: second\n");
  ASSERT_NE(first, text.npos) << text;
  ASSERT_NE(second, text.npos) << text;
  EXPECT_LT(first, second);
  EXPECT_EQ(text.substr(second - 19, 2), "20");  // a year
  EXPECT_EQ(text[second - 9], 'T');
}

}  // namespace
}  // namespace octurn
