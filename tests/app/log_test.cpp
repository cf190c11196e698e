#include "log.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

#include "file_descriptor.hpp"

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

TEST(Log, SpeaksToATerminalInWords) {
  const FileDescriptor terminal(::posix_openpt(O_RDWR | O_NOCTTY));
  ASSERT_EQ(::grantpt(terminal.number()), 0);
  ASSERT_EQ(::unlockpt(terminal.number()), 0);
  const FileDescriptor screen(::open(::ptsname(terminal.number()), O_RDWR | O_NOCTTY));
  const FileDescriptor usual(::dup(STDERR_FILENO));
  ::dup2(screen.number(), STDERR_FILENO);
  log::warning("scanner", "it slipped");
  ::dup2(usual.number(), STDERR_FILENO);

  std::array<char, 100> shown{};
  const ssize_t size = ::read(terminal.number(), shown.data(), shown.size());
  EXPECT_EQ(std::string(shown.data(), static_cast<std::size_t>(size)),
            "\r\033[Kwarning: scanner: it slipped\r\n");
}

}  // namespace
}  // namespace octurn
