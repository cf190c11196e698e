// The emulated Kinect as the kernel's vhci_hcd sees it. The tests play the kernel's end of the
// connection (Linux, Documentation/usb/usbip_protocol.rst).

#include "kinect/emulated/usbip_device.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>

namespace octurn {
namespace {

using Bytes = std::vector<std::uint8_t>;
constexpr std::uint32_t stall = 0xFFFFFFE0;     // -EPIPE
constexpr std::uint32_t unlinked = 0xFFFFFF98;  // -ECONNRESET

void append_word(Bytes& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) {
    bytes.push_back(static_cast<std::uint8_t>(value >> shift & 0xFFU));
  }
}

std::uint32_t word(const Bytes& bytes, std::size_t number) {
  std::uint32_t value = 0;
  for (std::size_t i = 4 * number; i < 4 * number + 4; ++i) {
    value = value << 8U | bytes.at(i);
  }
  return value;
}

struct Reply {
  Bytes header = {};
  Bytes data = {};
  std::vector<std::uint32_t> packets = {};  // bytes of each packet

  std::uint32_t status() const { return word(header, 5); }
};

/// A device, and the kernel's end of its connection.
class UsbipDeviceTest : public ::testing::Test {
 protected:
  UsbipDeviceTest() {
    std::iota(frame_.begin(), frame_.end(), std::uint16_t{0});
    std::ranges::for_each(frame_, [](std::uint16_t& reading) { reading &= 0x7FFU; });
    std::array<int, 2> ends = {};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    host_ = FileDescriptor(ends[0]);
    device_.emplace(KinectPart::camera, kinect_, camera_, FileDescriptor(ends[1]));
  }

  /// A motor on a connection of its own.
  void make_motor() {
    std::array<int, 2> ends = {};
    ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
    host_ = FileDescriptor(ends[0]);
    device_.emplace(KinectPart::motor, kinect_, camera_, FileDescriptor(ends[1]));
  }

  bool send(const Bytes& message) {
    EXPECT_EQ(::send(host_.number(), message.data(), message.size(), 0),
              static_cast<ssize_t>(message.size()));
    return device_->take_message();
  }

  Bytes receive(std::size_t count) {
    Bytes bytes(count);
    if (count > 0) {  // recv of 0 bytes would block
      EXPECT_EQ(::recv(host_.number(), bytes.data(), count, MSG_WAITALL),
                static_cast<ssize_t>(count));
    }
    return bytes;
  }

  static Bytes submit(std::uint32_t sequence, bool in, std::uint32_t endpoint, std::uint32_t bytes,
                      std::uint32_t packets, const Bytes& setup) {
    Bytes message;
    for (const std::uint32_t value :
         {1U, sequence, 0x10002U, in ? 1U : 0U, endpoint, 0U, bytes, 0U, packets, 0U}) {
      append_word(message, value);
    }
    message.insert(message.end(), setup.begin(), setup.end());
    return message;
  }

  Reply control(const Bytes& setup, const Bytes& data = {}) {
    const bool in = (setup[0] & 0x80U) != 0;
    const auto length = static_cast<std::uint32_t>(setup[6] | setup[7] << 8);
    Bytes message = submit(++sequence_, in, 0, length, 0xFFFFFFFF, setup);
    message.insert(message.end(), data.begin(), data.end());
    EXPECT_TRUE(send(message));
    Reply reply{.header = receive(48)};
    EXPECT_EQ(word(reply.header, 0), 3);
    EXPECT_EQ(word(reply.header, 1), sequence_);
    if (in) {
      reply.data = receive(word(reply.header, 6));
    }
    return reply;
  }

  /// Writes a register of the camera.
  void set_register(std::uint8_t address, std::uint8_t value) {
    const Reply reply =
        control({0x40, 0, 0, 0, 0, 0, 12, 0}, {'G', 'M', 2, 0, 3, 0, 7, 0, address, 0, value, 0});
    EXPECT_EQ(reply.status(), 0);
    EXPECT_EQ(word(reply.header, 6), 12);
  }

  bool submit_packets(std::uint32_t sequence, std::uint32_t count, std::uint32_t endpoint = 2) {
    Bytes message = submit(sequence, true, endpoint, count * 1920, count, Bytes(8));
    for (std::uint32_t i = 0; i < count; ++i) {
      for (const std::uint32_t value : {i * 1920, 1920U, 0U, 0U}) {
        append_word(message, value);
      }
    }
    return send(message);
  }

  Reply packets(std::uint32_t count) {
    Reply reply{.header = receive(48)};
    EXPECT_EQ(word(reply.header, 0), 3);
    EXPECT_EQ(reply.status(), 0);
    EXPECT_EQ(word(reply.header, 8), count);
    reply.data = receive(word(reply.header, 6));
    const Bytes descriptors = receive(std::size_t{16} * count);
    for (std::uint32_t i = 0; i < count; ++i) {
      EXPECT_EQ(word(descriptors, 4 * i), 1920 * i);
      reply.packets.push_back(word(descriptors, 4 * i + 2));
    }
    EXPECT_EQ(std::reduce(reply.packets.begin(), reply.packets.end()), reply.data.size());
    return reply;
  }

  /// All packets of an endpoint in one frame's 267 microframes.
  Reply frame_of_packets(std::uint32_t endpoint = 2) {
    Reply all;
    for (const std::uint32_t count : {100U, 100U, 67U}) {
      EXPECT_TRUE(submit_packets(++sequence_, count, endpoint));
      EXPECT_TRUE(device_->complete(*device_->due()));
      const Reply some = packets(count);
      all.data.insert(all.data.end(), some.data.begin(), some.data.end());
      all.packets.insert(all.packets.end(), some.packets.begin(), some.packets.end());
    }
    return all;
  }

  EmulatedKinect kinect_;
  std::vector<std::uint16_t> frame_ = std::vector<std::uint16_t>(EmulatedCamera::pixels);
  std::vector<std::uint16_t> infrared_ =
      std::vector<std::uint16_t>(EmulatedCamera::infrared_pixels, 0x155);
  EmulatedCamera camera_{
      kinect_, over_and_over(frame_), {}, over_and_over(infrared_, infrared_.size())};
  FileDescriptor host_;
  std::optional<UsbipDevice> device_;
  std::uint32_t sequence_ = 0;
};

TEST_F(UsbipDeviceTest, TellsWhatItIs) {
  const Reply device = control({0x80, 6, 0, 1, 0, 0, 18, 0});
  ASSERT_EQ(device.data.size(), 18);
  EXPECT_EQ(Bytes(device.data.begin() + 8, device.data.begin() + 14),
            (Bytes{0x5E, 0x04, 0xAE, 0x02, 0x0B, 0x01}));  // Microsoft's camera of model 1414

  const Reply serial = control({0x80, 6, 3, 3, 9, 4, 255, 0});
  EXPECT_EQ(serial.data.size(), 2 + 2 * kinect_serial_number.size());
  EXPECT_EQ(serial.data[2], 'A');
}

TEST_F(UsbipDeviceTest, HasTwoEndpointsWhosePacketsHold1920Bytes) {
  const Reply begin = control({0x80, 6, 0, 2, 0, 0, 9, 0});
  ASSERT_EQ(begin.data.size(), 9);  // no longer than requested
  const Reply all = control({0x80, 6, 0, 2, 0, 0, begin.data[2], 0});
  ASSERT_EQ(all.data.size(), begin.data[2]);
  std::vector<int> packet_bytes;
  for (std::size_t at = 0; at < all.data.size(); at += all.data[at]) {
    ASSERT_GT(all.data[at], 0);
    if (all.data[at + 1] == 5) {  // an endpoint: USB 2.0, table 9-13
      const int size = all.data[at + 4] | all.data[at + 5] << 8;
      packet_bytes.push_back((size & 0x7FF) * (1 + (size >> 11)));
    }
  }
  EXPECT_EQ(packet_bytes, (std::vector{1920, 1920}));
}

TEST_F(UsbipDeviceTest, TakesItsConfigurationAndStallsOnWhatItHasNot) {
  EXPECT_EQ(control({0x00, 9, 1, 0, 0, 0, 0, 0}).status(), 0);
  EXPECT_EQ(control({0x80, 8, 0, 0, 0, 0, 1, 0}).data, Bytes{1});
  EXPECT_EQ(control({0x80, 6, 0, 6, 0, 0, 10, 0}).status(), stall);  // there is no other speed
  EXPECT_EQ(control({0x40, 0, 0, 0, 0, 0, 8, 0}, Bytes(8)).status(), stall);  // not a command
}

TEST_F(UsbipDeviceTest, AnswersCommandsByTheirTag) {
  set_register(0x13, 0x42);
  control({0xC0, 0, 0, 0, 0, 0, 0, 2});  // discards the reply to the write
  control({0x40, 0, 0, 0, 0, 0, 10, 0}, {'G', 'M', 1, 0, 2, 0, 9, 0, 0x13, 0});
  EXPECT_EQ(control({0xC0, 0, 0, 0, 0, 0, 0, 2}).data,
            (Bytes{'R', 'B', 2, 0, 2, 0, 9, 0, 0, 0, 0x42, 0}));
}

TEST_F(UsbipDeviceTest, IsAMotorThatTellsItsAcceleration) {
  make_motor();
  kinect_.acceleration[1] = 0x0321;
  kinect_.acceleration[2] = -2;
  EXPECT_EQ(control({0xC0, 0x32, 0, 0, 0, 0, 10, 0}).data,
            (Bytes{0, 0, 0, 0, 0x03, 0x21, 0xFF, 0xFE, 0, 0}));
}

TEST_F(UsbipDeviceTest, SendsItsFramesInPackets) {
  set_register(0x06, 2);
  const Reply sent = frame_of_packets();
  std::vector<std::uint16_t> readings;
  std::uint32_t bits = 0;
  int held = 0;
  std::size_t at = 0;
  for (const std::uint32_t bytes : sent.packets) {
    for (std::size_t i = at + 12; i < at + bytes; ++i) {  // after the packet's header
      bits = bits << 8U | sent.data[i];
      for (held += 8; held >= 11; held -= 11) {
        readings.push_back(static_cast<std::uint16_t>(bits >> (held - 11) & 0x7FFU));
      }
    }
    at += bytes;
  }
  EXPECT_TRUE(readings == frame_) << readings.size();
  EXPECT_EQ(kinect_.frames_sent, 1);
}

TEST_F(UsbipDeviceTest, SendsNoDepthUnlessItIsAskedFor) {
  EXPECT_TRUE(frame_of_packets().data.empty());
  set_register(0x06, 2);
  EXPECT_TRUE(submit_packets(++sequence_, 16, 1));  // on the video endpoint
  EXPECT_TRUE(device_->complete(*device_->due()));
  EXPECT_TRUE(packets(16).data.empty());
}

TEST_F(UsbipDeviceTest, SendsInfraredPicturesOnTheVideoEndpoint) {
  set_register(0x1A, 1);
  set_register(0x1B, 30);
  set_register(0x05, 3);
  EXPECT_TRUE(frame_of_packets().data.empty());
  const Reply sent = frame_of_packets(1);
  EXPECT_EQ(std::ranges::count_if(sent.packets, [](std::uint32_t bytes) { return bytes > 0; }),
            205);
  EXPECT_EQ(sent.data.size(), 205 * 12 + infrared_.size() * 10 / 8);
  EXPECT_EQ(Bytes(sent.data.begin() + 12, sent.data.begin() + 17),
            Bytes({0x55, 0x55, 0x55, 0x55, 0x55}));
  set_register(0x05, 0);
  EXPECT_TRUE(frame_of_packets(1).data.empty());
}

TEST_F(UsbipDeviceTest, LosesThePacketsThatATestNames) {
  kinect_.first_lost = 7;
  kinect_.lost_packets = 2;
  set_register(0x06, 2);
  const Reply sent = frame_of_packets();
  for (std::size_t i = 0; i < 242; ++i) {
    EXPECT_EQ(sent.packets[i] == 0, i == 7 || i == 8) << i;
  }
  EXPECT_EQ(kinect_.frames_damaged, 1);
}

TEST_F(UsbipDeviceTest, TakesAMicroframeForEachPacketAtItsSpeed) {
  kinect_.speed = 0.5;
  EXPECT_TRUE(submit_packets(1, 16));
  EXPECT_TRUE(submit_packets(2, 32));
  const auto first = *device_->due();
  EXPECT_TRUE(device_->complete(first));
  EXPECT_EQ(*device_->due() - first, std::chrono::microseconds(32 * 250));
}

TEST_F(UsbipDeviceTest, CountsHowLateTransfersAreSubmittedAgain) {
  using Clock = UsbipDevice::Clock;
  EXPECT_TRUE(submit_packets(1, 8));
  EXPECT_TRUE(submit_packets(2, 8));
  const auto before = Clock::now();
  EXPECT_TRUE(device_->complete(*device_->due()));
  packets(8);
  const auto completed = Clock::now();
  while (Clock::now() < completed + std::chrono::milliseconds(2)) {
  }
  EXPECT_TRUE(device_->take_delays().empty());
  EXPECT_TRUE(submit_packets(3, 8));
  const auto delays = device_->take_delays();
  ASSERT_EQ(delays.size(), 1);
  EXPECT_GE(delays[0], std::chrono::milliseconds(2));
  EXPECT_LE(delays[0], Clock::now() - before);
  EXPECT_TRUE(device_->take_delays().empty());
}

TEST_F(UsbipDeviceTest, GivesBackAnUnlinkedTransferOnce) {
  EXPECT_TRUE(submit_packets(21, 8));
  EXPECT_TRUE(submit_packets(22, 8));
  const auto unlink = [&](std::uint32_t sequence, std::uint32_t of) {
    Bytes message;
    for (const std::uint32_t value : {2U, sequence, 0x10002U, 0U, 0U, of}) {
      append_word(message, value);
    }
    message.resize(48);
    EXPECT_TRUE(send(message));
    const Bytes reply = receive(48);
    EXPECT_EQ(word(reply, 0), 4);
    EXPECT_EQ(word(reply, 1), sequence);
    return word(reply, 5);
  };
  EXPECT_EQ(unlink(31, 21), unlinked);
  EXPECT_TRUE(device_->complete(*device_->due()));
  EXPECT_EQ(word(packets(8).header, 1), 22);
  EXPECT_EQ(unlink(32, 22), 0);
  EXPECT_FALSE(device_->due());
}

TEST_F(UsbipDeviceTest, EndsWithItsConnection) {
  host_ = FileDescriptor();
  EXPECT_FALSE(device_->take_message());
}

TEST_F(UsbipDeviceTest, EndsOnWhatIsNoMessage) {
  EXPECT_FALSE(send(Bytes(48, 0xFF)));
  EXPECT_FALSE(send(submit(1, true, 2, 0x7FFFFFFF, 16, Bytes(8))));
  EXPECT_FALSE(send(submit(1, true, 2, 1920, 0x7FFFFFFF, Bytes(8))));
}

}  // namespace
}  // namespace octurn
