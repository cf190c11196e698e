// Commands to the emulated camera, whose firmware has faults.

#include "kinect/camera_commands.hpp"

#include <gtest/gtest.h>

#include "kinect/emulated/usb_parts.hpp"
#include "octurn/error.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

/// A camera, and commands to it. Tests that end by success never reach the deadline.
class CameraCommandsTest : public ::testing::Test {
 protected:
  static CameraCommands::Clock::time_point in_time() { return CameraCommands::Clock::now() + 20s; }

  std::optional<std::size_t> transfer(std::uint8_t type, std::span<std::uint8_t> data) {
    return vendor_request(KinectPart::camera,
                          {.type = type, .length = static_cast<std::uint16_t>(data.size())},
                          kinect_, camera_, data);
  }

  void expect_parameters() {
    kinect_.baseline_cm = 7.25F;
    kinect_.shift = 201;
    const KinectParameters parameters = commands_.parameters(in_time());
    EXPECT_EQ(parameters.baseline_cm, 7.25);
    EXPECT_EQ(parameters.shift, 201);
  }

  EmulatedKinect kinect_ = {};
  std::vector<EmulatedCamera::Reading> frame_ =
      std::vector<EmulatedCamera::Reading>(EmulatedCamera::pixels);
  EmulatedCamera camera_{kinect_, over_and_over(frame_)};
  CameraCommands commands_{{.write =
                                [this](auto data, auto /*timeout*/) {
                                  std::vector<std::uint8_t> copy(data.begin(), data.end());
                                  const auto sent = transfer(0x40, copy);
                                  return sent ? static_cast<int>(*sent) : -1;
                                },
                            .read =
                                [this](auto data, auto /*timeout*/) {
                                  const auto received = transfer(0xC0, data);
                                  return received ? static_cast<int>(*received) : -1;
                                }}};
};

TEST_F(CameraCommandsTest, ReadTheFactorysParameters) { expect_parameters(); }

TEST_F(CameraCommandsTest, WriteRegisters) {
  commands_.write_register(0x06, 2, in_time());
  EXPECT_TRUE(kinect_.depth_on);
}

TEST_F(CameraCommandsTest, WaitForAReplyThatIsNotReady) {
  for (const int times : {1, 2, 20}) {
    kinect_.not_ready = times;
    expect_parameters();
  }
}

TEST_F(CameraCommandsTest, PassOverAStaleReply) {
  commands_.write_register(0x06, 2, in_time());
  kinect_.stale_replies = 2;
  expect_parameters();
  EXPECT_EQ(kinect_.stale_replies, 0);
}

TEST_F(CameraCommandsTest, AreSentAgainAfterAReplyThatIsCut) {
  kinect_.short_replies = 1;
  expect_parameters();
}

TEST_F(CameraCommandsTest, AreSentAgainAfterAStall) {
  kinect_.stalls = 3;
  expect_parameters();
  EXPECT_EQ(kinect_.stalls, 0);
}

TEST_F(CameraCommandsTest, GiveUpAtTheDeadline) {
  kinect_.not_ready = 1'000'000;
  try {
    commands_.parameters(CameraCommands::Clock::now() + 20ms);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::sensor_failed);
    EXPECT_STREQ(error.what(), "kinect: its camera does not answer command 4");
  }
}

TEST_F(CameraCommandsTest, RefuseParametersThatMakeNoSense) {
  kinect_.reference_pixel_cm = 0;
  EXPECT_THROW(commands_.parameters(in_time()), Error);
}

}  // namespace
}  // namespace octurn
