// Octurn's Kinect driver end to end: an emulated USB bus, and the program's sensor on top.

#include <OpenNI.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <span>
#include <thread>

#include "kinect/plain_frames.hpp"
#include "kinect/real_depths.hpp"
#include "octurn/units.hpp"
#include "rig/kinect_device.hpp"
#include "support/patience.hpp"
#include "support/thrown_error.hpp"
#include "turntable/real_time.hpp"

namespace octurn {
namespace {

using std::chrono::steady_clock;

TEST(KinectDriver, IsFoundAsAnySensor) {
  const KinectOnDesk desk({frame_of(700)});
  const auto sensor = open_sensor("");
  EXPECT_EQ(sensor->name(), "Kinect v1");
  EXPECT_EQ(sensor->serial(), "A00000000000000A");
  EXPECT_EQ(next_frame(*sensor).depth[0], std::lround(depth_of(700)));
}

// Frame n begins at least n periods after the first one; a busy machine may delay the driver.
TEST(KinectDriver, SendsAtMostThirtyFramesASecond) {
  KinectOnDesk desk(plain_frames(2));
  constexpr std::chrono::microseconds period(267 * 125);  // EmulatedCamera::microframes_in_frame
  const auto begin = steady_clock::now();
  const auto sensor = open_sensor("kinect://");
  int frames = 0;
  steady_clock::time_point last = begin;
  for (; frames < 30; ++frames) {
    const auto time = sensor->read({}).value().time;
    EXPECT_GT(time, last);
    last = time;
  }
  EXPECT_GE(last - begin, (frames - 1) * period);
  EXPECT_GE(desk->frames_sent, frames);
  EXPECT_EQ(desk->video_starts, 0);
}

/// Whether this process may give a thread that real-time priority.
bool may_have(int priority) {
  bool may = false;
  std::jthread([&] {
    const sched_param wanted{.sched_priority = priority};
    may = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &wanted) == 0;
  }).join();
  return may;
}

TEST(KinectDriver, TakesPacketsAboveTheReconstructionAndBelowTheStepperWhereItMay) {
  static_assert(usb_thread_priority > 0 && usb_thread_priority < real_time_priority);
  KinectOnDesk desk({frame_of(700)});
  const auto sensor = open_sensor("kinect://");
  next_frame(*sensor);
  EXPECT_EQ(desk->stream_priority, may_have(usb_thread_priority) ? usb_thread_priority : 0);
}

// The driver numbers the frames that it delivers; each frame's readings show its number on the
// sensor.
TEST(KinectDriver, DropsNoFrameOfTheSensors) {
  constexpr int different = 20;
  const KinectOnDesk desk(plain_frames(different));
  load_sensor_drivers();
  openni::Device device;
  ASSERT_EQ(device.open("kinect://"), openni::STATUS_OK);
  openni::VideoStream stream;
  ASSERT_EQ(stream.create(device, openni::SENSOR_DEPTH), openni::STATUS_OK);
  EXPECT_EQ(stream.getVideoMode().getFps(), 30);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  int index = 0;
  while (index < 2 * different) {
    openni::VideoFrameRef frame;
    ASSERT_EQ(stream.readFrame(&frame), openni::STATUS_OK);
    index = frame.getFrameIndex();
    const auto* depths = static_cast<const std::uint16_t*>(frame.getData());
    // Successive readings differ by 15 units of 0.1 mm.
    ASSERT_NEAR(depths[frame_pixels / 2], depth_of(600 + (index - 1) % different), 2) << index;
  }
  stream.destroy();
  device.close();
}

TEST(KinectDriver, ConvertsEveryReading) {
  Readings all(frame_pixels);
  for (std::size_t i = 0; i < frame_pixels; ++i) {
    all[i] = static_cast<std::uint16_t>(i % 2048);
  }
  const KinectOnDesk desk({all});
  const auto sensor = open_sensor("kinect://");
  const DepthFrame frame = next_frame(*sensor);
  for (std::size_t i = 0; i < frame_pixels; ++i) {
    const auto reading = static_cast<int>(i % 2048);
    const double depth = depth_of(reading);
    if (reading < 1036) {  // up to 6.47 m, where a unit in the constants' last digit makes 0.1 mm
      ASSERT_NEAR(frame.depth[i], depth, 0.5 + depth * depth * 1e-8) << reading;
    } else if (reading >= 1037) {
      ASSERT_EQ(frame.depth[i], 0) << reading;
    }
  }
}

TEST(KinectDriver, StampsFramesByTheSteadyClock) {
  const KinectOnDesk desk({frame_of(700)});
  const auto sensor = open_sensor("kinect://");
  const auto before = steady_clock::now();
  next_frame(*sensor);  // may have come before `before`
  next_frame(*sensor);  // may have begun before
  const auto first = sensor->read({})->time;
  EXPECT_GT(first, before);
  EXPECT_LE(first, steady_clock::now());
}

TEST(KinectDriver, UsesTheParametersOfTheUnit) {
  KinectOnDesk desk({frame_of(500), frame_of(500)});
  desk->baseline_cm = 7.62F;
  desk->reference_distance_cm = 121.5F;
  desk->reference_pixel_cm = 0.1047F;
  desk->shift = 190;
  const auto sensor = open_sensor("kinect://");

  const double shift = ((500 - 4 * 190) / 4.0 - 0.375) * 0.1047;
  const double mm = 10 * (shift * 121.5 / (7.62 - shift) + 121.5);
  EXPECT_NEAR(next_frame(*sensor).depth[0], 10 * mm, 0.5 + 0.01);  // parameters are floats
  EXPECT_NEAR(sensor->intrinsics().fx, 121.5 / (2 * 0.1047), 1e-2);
  EXPECT_GT(std::abs(10 * mm - depth_of(500)), 50);  // a typical unit's parameters would fail
}

TEST(KinectDriver, RefusesParametersThatMakeNoSense) {
  KinectOnDesk desk({frame_of(500)});
  desk->reference_pixel_cm = 0;
  const Error error = error_thrown_by([] { open_sensor("kinect://"); });
  EXPECT_NE(std::string(error.what()).find("factory parameters"), std::string::npos)
      << error.what();
}

TEST(KinectDriver, TellsItsTilt) {
  KinectOnDesk desk({frame_of(700)});
  const double pitch = radians_from_degrees(-25);
  const double roll = radians_from_degrees(3);
  const double g = 819;
  desk->acceleration[0] =
      static_cast<std::int16_t>(std::lround(g * std::cos(pitch) * std::sin(roll)));
  desk->acceleration[1] =
      static_cast<std::int16_t>(std::lround(g * std::cos(pitch) * std::cos(roll)));
  desk->acceleration[2] = static_cast<std::int16_t>(std::lround(g * std::sin(pitch)));
  const auto sensor = open_sensor("kinect://");

  const std::optional<Tilt> tilt = sensor->tilt();
  ASSERT_TRUE(tilt.has_value());
  EXPECT_NEAR(tilt->pitch, pitch, 1 / g);  // one count of the accelerometer
  EXPECT_NEAR(tilt->roll, roll, 1 / g);
}

TEST(KinectDriver, FollowsItsTilt) {
  KinectOnDesk desk({frame_of(700)});
  const auto sensor = open_sensor("kinect://");
  EXPECT_EQ(sensor->tilt()->pitch, 0);
  desk->acceleration[2] = 819;
  const auto deadline = steady_clock::now() + patience;
  while (sensor->tilt()->pitch == 0 && steady_clock::now() < deadline) {
    next_frame(*sensor);
  }
  EXPECT_NEAR(sensor->tilt()->pitch, std::numbers::pi / 4, 1e-9);
}

void expect_depth_without_firmware(KinectModel model) {
  KinectOnDesk desk({frame_of(700)});
  desk->model = model;
  const auto sensor = open_sensor("kinect://");
  EXPECT_EQ(next_frame(*sensor).depth[0], std::lround(depth_of(700)));
  EXPECT_EQ(sensor->tilt().has_value(), model == KinectModel::k1414);
  EXPECT_EQ(desk->near_mode, model == KinectModel::for_windows);
}

TEST(KinectDriver, TakesModel1414) { expect_depth_without_firmware(KinectModel::k1414); }

TEST(KinectDriver, TakesModel1473WithoutTilt) { expect_depth_without_firmware(KinectModel::k1473); }

TEST(KinectDriver, TakesAKinectForWindowsInNearModeWithoutTilt) {
  expect_depth_without_firmware(KinectModel::for_windows);
}

/// Recovers the readings from a real Kinect's depths, which are truncated to whole millimetres.
Readings readings_from_mm(std::span<const std::uint16_t> depths_mm) {
  Readings readings(frame_pixels, 2047);
  std::ranges::transform(depths_mm, readings.begin(), [](std::uint16_t depth_mm) {
    return static_cast<std::uint16_t>(std::ceil(1089.408 - 345489.4 / depth_mm - 0.02));
  });
  return readings;
}

TEST(KinectDriver, GivesTheDepthsOfARealKinect) {
  const KinectOnDesk desk({readings_from_mm(real_depths_mm)});
  const auto sensor = open_sensor("kinect://");
  const DepthFrame frame = next_frame(*sensor);
  for (std::size_t i = 0; i < real_depths_mm.size(); ++i) {
    // Rounding to 0.1 mm may reach the next whole millimetre.
    ASSERT_GE(frame.depth[i], 10 * real_depths_mm[i]);
    ASSERT_LE(frame.depth[i], 10 * real_depths_mm[i] + 10);
  }
  EXPECT_EQ(frame.depth[real_depths_mm.size()], 0);
}

TEST(KinectDriver, RefusesAUriThatIsNone) {
  const KinectOnDesk desk({frame_of(700)});
  const Error error = error_thrown_by([] { open_sensor("kinect://left"); });
  EXPECT_NE(std::string(error.what()).find("\"left\""), std::string::npos) << error.what();
  EXPECT_EQ(code_thrown_by([] { open_sensor("kinect://1"); }), "sensor-missing");
}

}  // namespace
}  // namespace octurn
