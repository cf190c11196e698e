// Opening a Kinect whose firmware is slow or faulty.

#include <gtest/gtest.h>

#include <chrono>

#include "kinect/emulated/usb_parts.hpp"
#include "kinect/plain_frames.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;
// Of the 5 s that an opening may take; a busy machine makes its waits longer, not endless.
constexpr auto longest_opening = 6 * std::chrono::seconds(5);

/// Opens an emulated Kinect after a change, and expects depth before long.
template <typename Change>
void expect_depth(Change change) {
  KinectOnDesk desk({frame_of(700)});
  change(desk.kinect());
  const auto begin = Clock::now();
  const auto sensor = open_sensor("kinect://");
  EXPECT_LT(Clock::now() - begin, longest_opening);
  EXPECT_EQ(next_frame(*sensor).depth[0], std::lround(depth_of(700)));
  EXPECT_EQ(desk->audio_resets, 0);
}

TEST(KinectOpening, WaitsForRepliesThatAreNotReady) {
  for (int times = 1; times <= 20; ++times) {
    expect_depth([&](EmulatedKinect& kinect) { kinect.not_ready = times; });
  }
}

TEST(KinectOpening, SurvivesAShortReplyAStaleOneAndAStall) {
  expect_depth([](EmulatedKinect& kinect) { kinect.short_replies = 1; });
  expect_depth([](EmulatedKinect& kinect) { kinect.stale_replies = 1; });
  expect_depth([](EmulatedKinect& kinect) { kinect.stalls = 1; });
}

// The audio part of these models would have to be reset for it, and vanishes then.
TEST(KinectOpening, LeavesTheAudioPartAlone) {
  expect_depth([](EmulatedKinect& kinect) { kinect.model = KinectModel::k1473; });
  expect_depth([](EmulatedKinect& kinect) { kinect.model = KinectModel::for_windows; });
}

// Their cameras have no serial number, and are known by that of their audio part.
TEST(KinectOpening, WaitsForAnAudioPartThatVanishedAfterAReset) {
  for (const KinectModel model : {KinectModel::k1473, KinectModel::for_windows}) {
    KinectOnDesk desk({frame_of(700)});
    desk->model = model;
    desk->audio_absences = 10;
    const auto sensor = open_sensor("kinect://");
    EXPECT_EQ(sensor->serial(), kinect_serial_number);
    EXPECT_GT(next_frame(*sensor).depth[0], 0);
  }
}

TEST(KinectOpening, GoesOnWithoutAnAudioPartThatStaysAway) {
  constexpr int for_ever = 1'000'000;
  KinectOnDesk desk({frame_of(700)});
  desk->model = KinectModel::k1473;
  desk->audio_absences = for_ever;
  const auto sensor = open_sensor("kinect://");
  EXPECT_NE(sensor->serial(), kinect_serial_number);
  EXPECT_GT(next_frame(*sensor).depth[0], 0);
}

TEST(KinectOpening, GoesOnWithoutAMotorThatNeverAnswers) {
  KinectOnDesk desk({frame_of(700)});
  desk->motor_hangs = true;
  const auto sensor = open_sensor("kinect://");
  EXPECT_FALSE(sensor->tilt().has_value());
  EXPECT_GT(next_frame(*sensor).depth[0], 0);
}

TEST(KinectOpening, SaysThatTheCameraDoesNotAnswer) {
  KinectOnDesk desk({frame_of(700)});
  desk->camera_hangs = true;
  const auto begin = Clock::now();
  const Error error = error_thrown_by([] { open_sensor("kinect://"); });
  EXPECT_LT(Clock::now() - begin, longest_opening);
  EXPECT_NE(std::string(error.what()).find("does not answer"), std::string::npos) << error.what();
}

}  // namespace
}  // namespace octurn
