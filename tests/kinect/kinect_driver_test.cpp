// Octurn's Kinect driver from end to end: an emulated USB bus below unmodified libfreenect, and the
// program's sensor on top.

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <span>

#include "kinect/kinect_on_desk.hpp"
#include "octurn/depth_png.hpp"
#include "octurn/units.hpp"
#include "sensor/depth_sensor.hpp"
#include "support/shared_folder.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t pixels = std::size_t{640} * 480;

Readings frame_of(std::uint16_t reading) { return Readings(pixels, reading); }

/// Frames that tell themselves apart: all of one reading each.
std::vector<Readings> plain_frames(int count) {
  std::vector<Readings> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(frame_of(static_cast<std::uint16_t>(600 + i)));
  }
  return frames;
}

/// z = 345489 / (1089.40 - reading) mm, in tenths.
double depth_of(int reading) { return 3454890 / (1089.40 - reading); }

DepthFrame next_frame(DepthSensor& sensor) { return sensor.read({}).value().frame; }

TEST(KinectDriver, IsFoundAsAnySensor) {
  const KinectOnDesk desk({frame_of(700)});
  const auto sensor = open_sensor("");
  EXPECT_EQ(sensor->name(), "Kinect v1");
  EXPECT_EQ(next_frame(*sensor).depth[0], std::lround(depth_of(700)));
}

// A busy machine holds frames up, but the emulated sensor sends all of them.
TEST(KinectDriver, SendsThirtyFramesASecond) {
  KinectOnDesk desk(plain_frames(2));
  const auto begin = steady_clock::now();
  const auto sensor = open_sensor("kinect://");
  while (desk->frames_sent < 30) {
    next_frame(*sensor);
  }
  const int sent = desk->frames_sent;
  const std::chrono::duration<double> elapsed = steady_clock::now() - begin;
  EXPECT_LT(sent / elapsed.count(), 31);
  EXPECT_GT(sent / elapsed.count(), 5);  // 29 where there is nothing else to do
  EXPECT_EQ(desk->video_starts, 0);
}

// The driver numbers the frames that it hands over, and these tell which of the sensor's they are.
TEST(KinectDriver, DropsNoFrameOfTheSensors) {
  constexpr int different = 20;
  const KinectOnDesk desk(plain_frames(different));
  load_sensor_drivers();
  openni::Device device;
  ASSERT_EQ(device.open("kinect://"), openni::STATUS_OK);
  openni::VideoStream stream;
  ASSERT_EQ(stream.create(device, openni::SENSOR_DEPTH), openni::STATUS_OK);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  int index = 0;
  while (index < 2 * different) {
    openni::VideoFrameRef frame;
    ASSERT_EQ(stream.readFrame(&frame), openni::STATUS_OK);
    index = frame.getFrameIndex();
    const auto* depths = static_cast<const std::uint16_t*>(frame.getData());
    // The next reading is 15 tenths of a millimetre away.
    ASSERT_NEAR(depths[pixels / 2], depth_of(600 + (index - 1) % different), 2) << index;
  }
  stream.destroy();
  device.close();
}

TEST(KinectDriver, ConvertsEveryReading) {
  Readings all(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    all[i] = static_cast<std::uint16_t>(i % 2048);
  }
  const KinectOnDesk desk({all});
  const auto sensor = open_sensor("kinect://");
  const DepthFrame frame = next_frame(*sensor);
  for (std::size_t i = 0; i < pixels; ++i) {
    const auto reading = static_cast<int>(i % 2048);
    const double depth = depth_of(reading);
    if (reading <
        1036) {  // beyond lie 6.47 m: one step of the constants' last digit is a tenth there
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
  next_frame(*sensor);  // it may have begun before
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
  EXPECT_GT(std::abs(10 * mm - depth_of(500)), 50);  // a typical unit's would not pass
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
  EXPECT_NEAR(tilt->pitch, pitch, 1 / g);  // a count
  EXPECT_NEAR(tilt->roll, roll, 1 / g);
}

TEST(KinectDriver, FollowsItsTilt) {
  KinectOnDesk desk({frame_of(700)});
  const auto sensor = open_sensor("kinect://");
  EXPECT_EQ(sensor->tilt()->pitch, 0);
  desk->acceleration[2] = 819;
  const auto deadline = steady_clock::now() + std::chrono::seconds(20);
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

struct Loss {
  int first = 0;
  int packets = 0;
  int cut = -1;
};

/// Of three frames one is damaged so, again and again.
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

TEST(KinectDriver, DropsFramesWithALostPacket) {
  expect_no_damaged_pixel({.first = 100, .packets = 1});
}

TEST(KinectDriver, DropsFramesWithSomeLostPackets) {
  expect_no_damaged_pixel({.first = 100, .packets = 3});
}

TEST(KinectDriver, DropsFramesWithALostBeginning) {
  expect_no_damaged_pixel({.first = 0, .packets = 1});
}

TEST(KinectDriver, DropsFramesWithALostEnd) {
  expect_no_damaged_pixel({.first = 241, .packets = 1});
}

TEST(KinectDriver, DropsFramesWithALossIntoTheNextFrame) {
  expect_no_damaged_pixel({.first = 240, .packets = 4});
}

TEST(KinectDriver, DropsFramesWithManyLostPackets) {
  expect_no_damaged_pixel({.first = 100, .packets = 50});
}

TEST(KinectDriver, DropsFramesWithAGreatLossIntoTheNextFrame) {
  expect_no_damaged_pixel({.first = 200, .packets = 60});
}

TEST(KinectDriver, DropsFramesWithAShortPacket) { expect_no_damaged_pixel({.cut = 120}); }

TEST(KinectDriver, DropsFramesWithAShortFirstPacket) { expect_no_damaged_pixel({.cut = 0}); }

TEST(KinectDriver, DropsFramesWithAShortLastPacket) { expect_no_damaged_pixel({.cut = 241}); }

TEST(KinectDriver, IsLostWhenUnpluggedAndFoundWhenPluggedInAgain) {
  KinectOnDesk desk(plain_frames(2));
  for (const char* uri : {"", "kinect://"}) {
    {
      const auto sensor = open_sensor(uri);
      next_frame(*sensor);
      desk.unplug();
      const Error error = error_thrown_by([&] {
        for (;;) {
          next_frame(*sensor);  // there may be one that came before
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

TEST(KinectDriver, IsFoundThoughItWasPluggedInAfterTheProgramStarted) {
  KinectOnDesk desk({frame_of(700)});
  desk.unplug();
  EXPECT_EQ(code_thrown_by([] { open_sensor(""); }), "sensor-missing");
  desk.plug_in();
  const auto sensor = open_sensor("");
  EXPECT_GT(next_frame(*sensor).depth[0], 0);
}

TEST(KinectDriver, SaysThatItIsSilent) {
  KinectOnDesk desk({frame_of(700)});
  desk->silent = true;
  const auto sensor = open_sensor("kinect://");
  EXPECT_EQ(code_thrown_by([&] { next_frame(*sensor); }), "sensor-silent");
}

TEST(KinectDriver, EndsItsTrafficWhenItIsClosed) {
  KinectOnDesk desk({frame_of(700)});
  {
    const auto sensor = open_sensor("kinect://");
    next_frame(*sensor);
    EXPECT_TRUE(desk->depth_on);
  }
  EXPECT_FALSE(desk->depth_on);
}

/// The readings from which a real Kinect's whole millimetres, cut off and not rounded, have come.
Readings readings_from_mm(const DepthFrame& frame) {
  Readings readings(pixels, 2047);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (frame.depth[i] != 0) {
      const double reading = std::ceil(1089.408 - 345489.4 / frame.depth[i] - 0.02);
      readings[i] = static_cast<std::uint16_t>(reading);
    }
  }
  return readings;
}

TEST(KinectDriver, GivesRealFramesAsTheyAre) {
  const fs::path folder = shared_folder() / "reference" / "real-depth";
  if (!fs::exists(folder)) {
    GTEST_SKIP() << "needs frames of real Kinects in " << folder;
  }
  int frames = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    // The others are of a unit whose parameters are not known.
    if (!entry.path().filename().string().starts_with("learn")) {
      continue;
    }
    const std::string png = content_of(entry.path());
    const DepthFrame real =
        decode_depth_png(entry.path().string(), std::as_bytes(std::span(png)), 640, 480);
    const KinectOnDesk desk({readings_from_mm(real)});
    const auto sensor = open_sensor("kinect://");
    const DepthFrame frame = next_frame(*sensor);
    for (std::size_t i = 0; i < pixels; ++i) {
      // Tenths round up to the next millimetre where the depth is within half a tenth of it.
      ASSERT_GE(frame.depth[i], 10 * real.depth[i]) << entry.path() << " " << i;
      ASSERT_LE(frame.depth[i], 10 * real.depth[i] + (real.depth[i] == 0 ? 0 : 10))
          << entry.path() << " " << i;
    }
    ++frames;
  }
  EXPECT_GT(frames, 0);
}

TEST(KinectDriver, RefusesAUriThatIsNone) {
  const KinectOnDesk desk({frame_of(700)});
  const Error error = error_thrown_by([] { open_sensor("kinect://left"); });
  EXPECT_NE(std::string(error.what()).find("\"left\""), std::string::npos) << error.what();
  EXPECT_EQ(code_thrown_by([] { open_sensor("kinect://1"); }), "sensor-missing");
}

}  // namespace
}  // namespace octurn
