#include "rig/usb_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "octurn/error.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr int packets_in_frame = 242;

/// A packet of depth. @param number  counted since the stream began
UsbPacket packet_of(int number, std::int64_t time_us) {
  const int place = number % packets_in_frame;
  const auto flag = static_cast<std::uint8_t>(place == 0                      ? 0x71
                                              : place == packets_in_frame - 1 ? 0x75
                                                                              : 0x72);
  return {.time_us = time_us,
          .bytes = 1760,
          .header = {'R', 'B', 0, flag, 0, static_cast<std::uint8_t>(number)}};
}

/// What arrives of some frames, at 30 a second.
/// @param lost  ranges of packets that do not: first, count
std::vector<UsbPacket> arrivals(int frames, const std::vector<std::pair<int, int>>& lost) {
  std::vector<UsbPacket> packets;
  for (int number = 0; number < frames * packets_in_frame; ++number) {
    const bool is_lost = std::ranges::any_of(lost, [&](const auto& range) {
      return number >= range.first && number < range.first + range.second;
    });
    if (!is_lost) {
      packets.push_back(packet_of(number, 1'000'000 + number * 1'000'000LL / 7260));
    }
  }
  return packets;
}

/// Expects that exactly these packets are found to be lost of four frames.
void expect_lost(const std::vector<std::pair<int, int>>& lost) {
  std::vector<bool> expected(4 * packets_in_frame);
  for (const auto& [first, count] : lost) {
    std::fill_n(expected.begin() + first, count, true);
  }
  EXPECT_TRUE(lost_packets(arrivals(4, lost)) == expected) << lost.front().first;
}

const std::string golden =
    "octurn-usb 1\n# Octurn 0.1.0\n@ 0\n1760 524200710000000000000000\n. 2\n! 1\n@ 2000\n"
    "1144 52420075000100a0b0c0d0ff\nend\n";

std::vector<UsbPacket> golden_packets() {
  return {{.bytes = 1760, .header = {'R', 'B', 0, 0x71}},
          {},
          {},
          {.status = 1},
          {.time_us = 2000,
           .bytes = 1144,
           .header = {'R', 'B', 0, 0x75, 0, 1, 0, 0xA0, 0xB0, 0xC0, 0xD0, 0xFF}}};
}

std::string refusal_of(const std::string& text) {
  const Error error = error_thrown_by([&] { parse_usb_log(text); });
  EXPECT_EQ(error.code(), ErrorCode::recording_malformed);
  return error.what();
}

TEST(UsbLog, IsAText) {
  std::vector<UsbPacket> packets = golden_packets();
  for (UsbPacket& packet : packets) {
    packet.time_us += 123'456'789;
  }
  EXPECT_EQ(to_usb_log_text(packets, std::vector<std::string>{"Octurn 0.1.0"}), golden);
}

TEST(UsbLog, IsReadAsItWasWritten) {
  EXPECT_EQ(parse_usb_log(golden), golden_packets());
  EXPECT_EQ(parse_usb_log("octurn-usb 1\nend\n"), std::vector<UsbPacket>());
}

TEST(UsbLog, RefusesEveryPartOfAFileAndWhatFollowsIt) {
  for (std::size_t size = 0; size < golden.size(); ++size) {
    refusal_of(golden.substr(0, size));
  }
  EXPECT_EQ(refusal_of(golden + "end\n"), "recording of USB, line 9: something follows its end");
}

TEST(UsbLog, NamesTheLineThatIsWrong) {
  const auto refusal = [](const std::string& line) {
    return refusal_of("octurn-usb 1\n@ 5\n" + line + "\nend\n");
  };
  const std::string header = " 524200710000000000000000";
  EXPECT_EQ(refusal_of("octurn-usb 2\nend\n"),
            "recording of USB, line 1: this is no file of octurn record --usb, or of a newer "
            "version");
  EXPECT_EQ(refusal_of("octurn-usb 1\n. 1\nend\n"),
            "recording of USB, line 2: a time is expected before the first packet");
  EXPECT_EQ(refusal("@ 4"),
            "recording of USB, line 3: a whole number from 5 to 600000000 is expected");
  for (const std::string& line : std::vector<std::string>{
           ". 0", ". ", ".", ". 480001", "! 0", "! 65536", "@ 600000001", "", "0" + header,
           "65536" + header, "1760", "1760 5242", "1760" + header + "00",
           "1760 52420071000000000000000G", "-1" + header, "? 1"}) {
    EXPECT_EQ(refusal(line).substr(0, 25), "recording of USB, line 3:") << line;
  }
  EXPECT_EQ(refusal(". 480000\n. 1"), "recording of USB, line 4: it has more than 480000 packets");
}

TEST(UsbLog, ShowsWhichPacketsWereLost) {
  expect_lost({{100, 1}});
  expect_lost({{1, 240}, {300, 100}, {970 - 5, 2}});
}

// Sequence numbers begin again after 256.
TEST(UsbLog, ShowsLongLossesByTheirTimes) {
  expect_lost({{20, 600}});
  expect_lost({{20, 900}});
}

TEST(UsbLog, ShowsNoLossWherePacketsCameLate) {
  std::vector<UsbPacket> packets = arrivals(2, {});
  for (std::size_t i = 50; i < packets.size(); ++i) {
    packets[i].time_us += 32'000;  // all that was in flight
  }
  EXPECT_TRUE(lost_packets(packets) == std::vector<bool>(2 * packets_in_frame));
}

TEST(UsbLog, BeginsAndEndsWithAFrame) {
  std::vector<UsbPacket> packets = arrivals(3, {{0, 1}});
  packets.resize(packets.size() - 10);
  EXPECT_EQ(lost_packets(packets).size(), packets_in_frame);
  EXPECT_TRUE(lost_packets(golden_packets()).empty());
}

}  // namespace
}  // namespace octurn
