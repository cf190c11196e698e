// Losses that Octurn's Kinect driver must not pass on as readings: packets, frames, the whole
// sensor.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <variant>
#include <vector>

#include "kinect/plain_frames.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

struct Loss {
  int first = 0;
  int packets = 0;
  int cut = -1;
};

/// Damages every third frame in this way, and reads frames: all readings of each must be its own.
/// @return the number of lost pixels of each damaged frame that was delivered
std::vector<std::size_t> lost_pixels(const Loss& loss) {
  KinectOnDesk desk(plain_frames(12));
  desk->speed = 2;
  desk->loss_period = 3;
  desk->first_lost = loss.first;
  desk->lost_packets = loss.packets;
  desk->cut_packet = loss.cut;
  const auto sensor = open_sensor("kinect://");
  std::vector<std::size_t> lost;
  for (int i = 0; i < 12; ++i) {
    const TimedFrame timed = sensor->read({}).value();
    const auto depth = std::ranges::max(timed.frame.depth);
    const auto readings = std::ranges::count(timed.frame.depth, depth);
    EXPECT_EQ(static_cast<std::size_t>(readings) + timed.lost.size(), frame_pixels)
        << "frame " << i;
    const auto reading = static_cast<int>(std::lround(1089.40 - 3454890.0 / depth));
    if (reading % 3 == 0) {
      lost.push_back(timed.lost.size());
    }
  }
  EXPECT_GT(desk->frames_damaged, 2);
  return lost;
}

/// Expects frames that lack so many packets; each has up to 1273 readings, the last one 824.
void expect_partial_frames(const Loss& loss, std::size_t packets) {
  const std::vector<std::size_t> lost = lost_pixels(loss);
  EXPECT_GE(lost.size(), 2);
  for (const std::size_t count : lost) {
    EXPECT_GE(count + 450, packets * 1271);
    EXPECT_LE(count, packets * 1273);
  }
}

TEST(KinectLosses, LeaveTheRestOfAFrame) {
  expect_partial_frames({.first = 100, .packets = 1}, 1);
  expect_partial_frames({.first = 100, .packets = 3}, 3);
}

TEST(KinectLosses, LeaveTheRestOfAFrameWithoutItsBeginning) {
  expect_partial_frames({.first = 0, .packets = 1}, 1);
}

TEST(KinectLosses, LeaveTheRestOfAFrameWithoutItsEnd) {
  expect_partial_frames({.first = 241, .packets = 1}, 1);
}

TEST(KinectLosses, LeaveTheRestOfBothFramesIfTheyReachIntoTheNext) {
  expect_partial_frames({.first = 240, .packets = 4}, 2);
  expect_partial_frames({.first = 200, .packets = 60}, 42);
}

TEST(KinectLosses, LeaveTheRestOfAFrameWithAShortPacket) {
  for (const int cut : {0, 120, 241}) {
    expect_partial_frames({.cut = cut}, 1);
  }
}

TEST(KinectLosses, DropFramesOfWhichMoreThanAFifthIsLost) {
  EXPECT_TRUE(lost_pixels({.first = 100, .packets = 50}).empty());
}

TEST(KinectLosses, AreToldIfNoFrameIsLeft) {
  KinectOnDesk desk(plain_frames(2));
  desk->random_loss = 0.3;
  const auto sensor = open_sensor("kinect://");
  const Error error = error_thrown_by([&] { next_frame(*sensor); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_silent);
  EXPECT_NEAR(std::get<double>(error.parameters().at("lost_share")), 0.3, 0.05) << error.what();
  desk->random_loss = 0;
  EXPECT_GT(next_frame(*sensor).depth[0], 0);
}

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

TEST(KinectLosses, EndWithinTwoSecondsWhenItIsClosedThoughItHangs) {
  KinectOnDesk desk({frame_of(700)});
  auto sensor = open_sensor("kinect://");
  next_frame(*sensor);
  desk->camera_hangs = true;
  desk->keeps_transfers = true;
  const auto begin = std::chrono::steady_clock::now();
  sensor.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
  desk->camera_hangs = false;
  desk->keeps_transfers = false;
  EXPECT_GT(next_frame(*open_sensor("kinect://")).depth[0], 0);
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
