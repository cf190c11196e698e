// Frames from packets of the emulated camera, some of which are lost. Each frame's readings show
// their place and the frame's number: a reading at a wrong place, or of another frame, is seen.

#include "kinect/packet_frames.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "kinect/emulated/camera.hpp"

namespace octurn {
namespace {

/// Packets of the emulated camera, and the frames that are made of those that are not lost.
class Wire {
 public:
  explicit Wire(const PacketFormat& format) : format_(format) {
    if (is_depth_) {
      write_register(0x06, 2);
    } else {
      write_register(0x1A, 1);
      write_register(0x1B, 30);
      write_register(0x48, 0);
      write_register(0x05, 3);
    }
  }

  /// Sends packets. @param is_lost  by a packet's number in the stream
  template <typename IsLost>
  void send(int packets, IsLost is_lost) {
    std::array<std::uint8_t, 1920> packet = {};
    for (const int end = number_ + packets; number_ < end;) {
      time_ += std::chrono::microseconds(125);
      const int bytes = camera_.next_packet(
          packet, is_depth_ ? EmulatedCamera::depth_endpoint : EmulatedCamera::video_endpoint);
      if (bytes > 0 && !is_lost(number_++)) {
        frames_.take(std::span(packet).first(static_cast<std::size_t>(bytes)), time_);
      }
    }
  }

  /// The numbers of lost packets of each frame.
  const std::vector<std::vector<int>>& lost() const { return lost_; }
  const std::vector<PacketFrames::Clock::time_point>& begins() const { return begins_; }

 private:
  void write_register(std::uint8_t address, std::uint8_t value) {
    EXPECT_TRUE(camera_.command(
        std::array<std::uint8_t, 12>{'G', 'M', 2, 0, 3, 0, 7, 0, address, 0, value, 0}));
  }

  /// The picture of a frame: each reading shows its place and the frame.
  std::span<const EmulatedCamera::Reading> picture(int frame) {
    for (std::size_t i = 0; i < picture_.size(); ++i) {
      picture_[i] = static_cast<EmulatedCamera::Reading>((i + static_cast<std::size_t>(frame) * 7) %
                                                         modulus_);
    }
    return picture_;
  }

  void check(const ReceivedFrame& frame) {
    std::vector<std::uint16_t> readings(picture_.size());
    unpack_readings(frame, format_, readings);
    std::set<std::size_t> pictures;
    std::size_t lost = 0;
    for (std::size_t pixel = 0; pixel < readings.size(); ++pixel) {
      if (readings[pixel] == lost_reading) {
        ++lost;
      } else {
        pictures.insert((readings[pixel] + modulus_ - pixel % modulus_) % modulus_);
      }
    }
    EXPECT_EQ(pictures.size(), 1) << "readings of several frames, or at wrong places";
    // A packet has 1271.3 readings of depth, or 1526.4 infrared ones, and the last one less; those
    // at its ends are lost as a whole.
    const std::size_t of_packet = 8 * format_.payload_bytes / format_.reading_bits;
    EXPECT_GE(lost + 600, frame.lost.size() * of_packet);
    EXPECT_LE(lost, frame.lost.size() * (of_packet + 2));
    lost_.emplace_back(frame.lost.begin(), frame.lost.end());
    begins_.push_back(frame.begin);
  }

  PacketFormat format_;
  bool is_depth_ = format_.stream == depth_packets.stream;
  // Primes: their multiples fit neither rows nor packets.
  std::size_t modulus_ = is_depth_ ? 2039 : 1021;
  std::vector<EmulatedCamera::Reading> picture_ =
      std::vector<EmulatedCamera::Reading>(8 * format_.frame_bytes / format_.reading_bits);
  EmulatedKinect kinect_ = {};
  EmulatedCamera camera_{kinect_,
                         [this](int frame) { return picture(frame); },
                         {},
                         [this](int frame) { return picture(frame); }};
  PacketFrames frames_{format_, [this](const ReceivedFrame& frame) { check(frame); }};
  PacketFrames::Clock::time_point time_ = {};
  int number_ = 0;
  std::vector<std::vector<int>> lost_ = {};
  std::vector<PacketFrames::Clock::time_point> begins_ = {};
};

using Lost = std::vector<std::vector<int>>;

class PacketFramesOf : public ::testing::TestWithParam<PacketFormat> {
 protected:
  int of_frame = GetParam().packets();
};

INSTANTIATE_TEST_SUITE_P(Streams, PacketFramesOf,
                         ::testing::Values(depth_packets, infrared_packets),
                         [](const ::testing::TestParamInfo<PacketFormat>& tested) {
                           return tested.param.stream == depth_packets.stream ? "depth"
                                                                              : "infrared";
                         });

TEST(PacketFrames, AreOfAsManyPacketsAsTheCameraSends) {
  EXPECT_EQ(depth_packets.packets(), EmulatedCamera::packets_in_frame);
  EXPECT_EQ(infrared_packets.packets(), 205);
}

TEST_P(PacketFramesOf, AreWholeIfNothingIsLost) {
  Wire wire(GetParam());
  wire.send(3 * of_frame, [](int) { return false; });
  EXPECT_EQ(wire.lost(), (Lost{{}, {}, {}}));
}

TEST_P(PacketFramesOf, BeginInTheMiddleOfAStream) {
  Wire wire(GetParam());
  wire.send(3 * of_frame, [](int packet) { return packet < 100; });
  EXPECT_EQ(wire.lost(), (Lost{{}, {}}));
}

TEST_P(PacketFramesOf, LackThePacketsThatWereLost) {
  Wire wire(GetParam());
  wire.send(3 * of_frame,
            [&](int packet) { return packet >= of_frame + 60 && packet < of_frame + 66; });
  EXPECT_EQ(wire.lost(), (Lost{{}, {60, 61, 62, 63, 64, 65}, {}}));
}

TEST_P(PacketFramesOf, LackTheirFirstAndLastPackets) {
  Wire wire(GetParam());
  const std::set<int> lost{of_frame - 1, of_frame, 3 * of_frame, 5 * of_frame - 1};
  wire.send(6 * of_frame, [&](int packet) { return lost.contains(packet); });
  EXPECT_EQ(wire.lost(), (Lost{{of_frame - 1}, {0}, {}, {0}, {of_frame - 1}, {}}));
}

// The sequence number tells a loss's length modulo 256 only.
TEST_P(PacketFramesOf, HaveNoReadingAtAWrongPlaceWhateverIsLost) {
  for (const int length : {1, 5, 20, 100, of_frame - 1, of_frame, of_frame + 1, 255, 256, 257, 300,
                           2 * of_frame, of_frame + 256, 512}) {
    for (const int begin : {of_frame + 8, of_frame + 200, 2 * of_frame - 1}) {
      Wire wire(GetParam());
      wire.send(7 * of_frame, [&](int packet) {
        return packet == begin - 3 || (packet >= begin && packet < begin + length);
      });
      ASSERT_GE(wire.lost().size(), 3) << length << " from " << begin;
      EXPECT_TRUE(wire.lost().front().empty());
      EXPECT_TRUE(wire.lost().back().empty());
    }
  }
}

TEST_P(PacketFramesOf, KeepNearlyAllThatArrivesUnderRandomLosses) {
  for (const double share : {0.01, 0.02, 0.05}) {
    Wire wire(GetParam());
    std::mt19937 random(7);
    int arrived = 0;
    const int sent = 60 * of_frame;
    wire.send(sent, [&](int) {
      const bool lost = std::uniform_real_distribution()(random) < share;
      arrived += lost ? 0 : 1;
      return lost;
    });
    int kept = 0;
    for (const std::vector<int>& lost : wire.lost()) {
      kept += of_frame - static_cast<int>(lost.size());
    }
    // What is in doubt at the end of a frame is lost, too, if the next one's first packet is: in
    // one of 1/share^2 frames, at most a frame. The stream's last frame may have no end.
    EXPECT_GE(kept, arrived - of_frame - static_cast<int>(sent * share * share)) << share;
  }
}

TEST_P(PacketFramesOf, BeginWhenTheirFirstPacketWasDue) {
  Wire whole(GetParam());
  Wire cut(GetParam());
  whole.send(3 * of_frame, [](int) { return false; });
  cut.send(3 * of_frame, [&](int packet) { return packet >= of_frame && packet < of_frame + 20; });
  EXPECT_EQ(cut.begins(), whole.begins());
}

TEST(PacketFrames, IgnoreWhatIsNoneOfTheirs) {
  int frames = 0;
  PacketFrames of_depth(depth_packets, [&](const ReceivedFrame&) { ++frames; });
  std::vector<std::uint8_t> packet(1760);
  const auto send = [&](std::uint8_t first, std::uint8_t flag, std::size_t bytes) {
    packet[0] = first;
    packet[1] = 'B';
    packet[3] = flag;
    of_depth.take(std::span(packet).first(bytes), {});
  };
  send('R', 0x81, 1760);  // of the video stream
  send('R', 0x77, 1760);
  send('X', 0x71, 1760);
  send('R', 0x71, 11);  // no whole header
  send('R', 0x75, 1144);
  send('R', 0x75, 1144);
  EXPECT_EQ(frames, 0);
}

}  // namespace
}  // namespace octurn
