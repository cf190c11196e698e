// Losses that Octurn's Kinect driver must not pass on as data: packets, frames, the whole sensor.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "kinect/plain_frames.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

struct Loss {
  int first = 0;
  int packets = 0;
  int cut = -1;
};

/// Damages every third frame in this way, and expects that no damaged frame is delivered.
void expect_no_damaged_pixel(const Loss& loss) {
  KinectOnDesk desk(plain_frames(12));
  desk->speed = 2;
  desk->loss_period = 3;
  desk->first_lost = loss.first;
  desk->lost_packets = loss.packets;
  desk->cut_packet = loss.cut;
  const auto sensor = open_sensor("kinect://");
  for (int i = 0; i < 8; ++i) {
    const DepthFrame frame = next_frame(*sensor);
    ASSERT_TRUE(std::ranges::all_of(frame.depth,
                                    [&](std::uint16_t depth) { return depth == frame.depth[0]; }))
        << "frame " << i;
    const auto reading = static_cast<int>(std::lround(1089.40 - 3454890.0 / frame.depth[0]));
    EXPECT_NE(reading % 3, 0) << "one of every third, which are damaged";
  }
  EXPECT_GT(desk->frames_damaged, 2);
}

TEST(KinectLosses, DropsFramesWithALostPacket) {
  expect_no_damaged_pixel({.first = 100, .packets = 1});
}

TEST(KinectLosses, DropsFramesWithSomeLostPackets) {
  expect_no_damaged_pixel({.first = 100, .packets = 3});
}

TEST(KinectLosses, DropsFramesWithALostBeginning) {
  expect_no_damaged_pixel({.first = 0, .packets = 1});
}

TEST(KinectLosses, DropsFramesWithALostEnd) {
  expect_no_damaged_pixel({.first = 241, .packets = 1});
}

TEST(KinectLosses, DropsFramesWithALossIntoTheNextFrame) {
  expect_no_damaged_pixel({.first = 240, .packets = 4});
}

TEST(KinectLosses, DropsFramesWithManyLostPackets) {
  expect_no_damaged_pixel({.first = 100, .packets = 50});
}

TEST(KinectLosses, DropsFramesWithAGreatLossIntoTheNextFrame) {
  expect_no_damaged_pixel({.first = 200, .packets = 60});
}

TEST(KinectLosses, DropsFramesWithAShortPacket) { expect_no_damaged_pixel({.cut = 120}); }

TEST(KinectLosses, DropsFramesWithAShortFirstPacket) { expect_no_damaged_pixel({.cut = 0}); }

TEST(KinectLosses, DropsFramesWithAShortLastPacket) { expect_no_damaged_pixel({.cut = 241}); }

TEST(KinectLosses, IsLostWhenUnpluggedAndFoundWhenPluggedInAgain) {
  KinectOnDesk desk(plain_frames(2));
  for (const char* uri : {"", "kinect://"}) {
    {
      const auto sensor = open_sensor(uri);
      next_frame(*sensor);
      desk.unplug();
      const Error error = error_thrown_by([&] {
        for (;;) {
          next_frame(*sensor);  // frames that arrived before may remain
        }
      });
      EXPECT_EQ(error.code(), ErrorCode::sensor_lost);
    }
    EXPECT_EQ(code_thrown_by([&] { open_sensor(uri); }), "sensor-missing");
    desk.plug_in();
  }
  const auto again = open_sensor("kinect://0");
  EXPECT_GT(next_frame(*again).depth[0], 0);
}

TEST(KinectLosses, IsFoundThoughItWasPluggedInAfterTheProgramStarted) {
  KinectOnDesk desk({frame_of(700)});
  desk.unplug();
  EXPECT_EQ(code_thrown_by([] { open_sensor(""); }), "sensor-missing");
  desk.plug_in();
  const auto sensor = open_sensor("");
  EXPECT_GT(next_frame(*sensor).depth[0], 0);
}

TEST(KinectLosses, SaysThatItIsSilent) {
  KinectOnDesk desk({frame_of(700)});
  desk->silent = true;
  const auto sensor = open_sensor("kinect://");
  EXPECT_EQ(code_thrown_by([&] { next_frame(*sensor); }), "sensor-silent");
}

TEST(KinectLosses, AreNoSignalsThatInterruptItsWait) {
  KinectOnDesk desk({frame_of(700)});
  const auto sensor = open_sensor("kinect://");
  next_frame(*sensor);
  desk->interruptions = 3;
  for (int i = 0; i < 20 || desk->interruptions > 0; ++i) {
    EXPECT_GT(next_frame(*sensor).depth[0], 0);
  }
}

TEST(KinectLosses, EndsItsTrafficWhenItIsClosed) {
  KinectOnDesk desk({frame_of(700)});
  {
    const auto sensor = open_sensor("kinect://");
    next_frame(*sensor);
    EXPECT_TRUE(desk->depth_on);
  }
  EXPECT_FALSE(desk->depth_on);
}

}  // namespace
}  // namespace octurn
