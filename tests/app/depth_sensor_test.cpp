#include "sensor/depth_sensor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

TEST(DepthSensor, FindsOcturnsDriversAndNotTheSystemsSet) {
  const DepthSensor sensor("octurn-simulator://");

  EXPECT_EQ(sensor.name(), "Kinect v1 (simulated)");
  const std::string loaded = content_of("/proc/self/maps");
  EXPECT_NE(loaded.find("/lib/octurn/OpenNI2/Drivers/libOcturnSimulator.so.0"), std::string::npos);
  EXPECT_EQ(loaded.find("libDummyDevice"), std::string::npos);  // which the system's set holds
}

TEST(DepthSensor, FindsNoSimulatedSensorUnlessAskedForIt) {
  EXPECT_TRUE(DepthSensor("octurn-simulator://").read({}).has_value());

  try {
    const DepthSensor any("");
    EXPECT_EQ(any.name().find("simulated"), std::string::npos);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "sensor-missing");
    EXPECT_FALSE(error.hint().empty());
  }
}

TEST(DepthSensor, HasTheIntrinsicsOfAKinect) {
  const DepthSensor sensor("octurn-simulator://");

  const Intrinsics& intrinsics = sensor.intrinsics();
  EXPECT_EQ(intrinsics.width, 640);
  EXPECT_EQ(intrinsics.height, 480);
  EXPECT_NEAR(intrinsics.fx, 575.8, 1e-3);  // OpenNI2 tells fields of view as floats
  EXPECT_NEAR(intrinsics.fy, 575.8, 1e-3);
  EXPECT_EQ(intrinsics.cx, 320);
  EXPECT_EQ(intrinsics.cy, 240);
  EXPECT_EQ(intrinsics.depth_unit, 0.0001);
}

/// The times between frames, from the shortest, at so many times the speed of life.
std::vector<steady_clock::duration> gaps_between_frames(int frames, const std::string& speed) {
  DepthSensor sensor("octurn-simulator://?speed=" + speed);
  std::vector<steady_clock::duration> gaps;
  auto last = sensor.read({})->time;
  for (int i = 1; i < frames; ++i) {
    const auto time = sensor.read({})->time;
    gaps.push_back(time - last);
    last = time;
  }
  std::ranges::sort(gaps);
  return gaps;
}

TEST(DepthSensor, StampsFramesByTheSteadyClock) {
  DepthSensor sensor("octurn-simulator://");
  const auto before = steady_clock::now();
  const auto first = sensor.read({})->time;
  const auto second = sensor.read({})->time;
  EXPECT_GT(first, before);
  EXPECT_GT(second, first);
  EXPECT_LE(second, steady_clock::now());
}

// A busy machine makes gaps longer, and that after a frame that was taken late shorter: only the
// middle one of several has a lower bound.
TEST(DepthSensor, SendsThirtyFramesASecondAtMost) {
  EXPECT_GT(gaps_between_frames(32, "1")[15], milliseconds(31));
}

TEST(DepthSensor, IsSlowerOrFasterThanLifeIfTold) {
  EXPECT_GT(gaps_between_frames(8, "0.25")[3], milliseconds(125));  // 133 ms, 33 in life
  EXPECT_LT(gaps_between_frames(4, "100")[1], milliseconds(125));
}

TEST(DepthSensor, ReadsNothingWhenStopped) {
  DepthSensor sensor("octurn-simulator://?silent-after=0");
  const auto begin = steady_clock::now();
  std::jthread stopper;
  std::stop_source stop;
  stopper = std::jthread([&stop] { stop.request_stop(); });

  EXPECT_FALSE(sensor.read(stop.get_token()).has_value());
  EXPECT_LT(steady_clock::now() - begin, milliseconds(1000));  // silence is given 2000
}

TEST(DepthSensor, SaysThatItIsSilent) {
  DepthSensor sensor("octurn-simulator://?silent-after=2");
  EXPECT_TRUE(sensor.read({}).has_value());
  EXPECT_TRUE(sensor.read({}).has_value());
  const auto begin = steady_clock::now();

  const Error error = error_thrown_by([&] { sensor.read({}); });

  EXPECT_EQ(error.code(), "sensor-silent");
  EXPECT_STREQ(error.what(), "sensor: no frame for 2000 ms");
  EXPECT_GE(steady_clock::now() - begin, milliseconds(2000));
}

TEST(DepthSensor, SaysThatItIsLostAndCanBeOpenedAgain) {
  const char* uri = "octurn-simulator://?lost-after=2";
  {
    DepthSensor sensor(uri);
    EXPECT_TRUE(sensor.read({}).has_value());
    EXPECT_TRUE(sensor.read({}).has_value());
    const Error error = error_thrown_by([&] { sensor.read({}); });
    EXPECT_EQ(error.code(), "sensor-lost");
    EXPECT_FALSE(error.hint().empty());
  }
  DepthSensor again(uri);
  EXPECT_TRUE(again.read({}).has_value());
}

TEST(DepthSensor, RefusesAnUnknownDevice) {
  const Error error = error_thrown_by([] { DepthSensor("no-such-device://1"); });

  EXPECT_EQ(error.code(), "sensor-missing");
  EXPECT_NE(std::string(error.what()).find("no-such-device://1"), std::string::npos);
}

TEST(DepthSensor, RefusesASettingThatTheSimulatorHasNot) {
  const Error error = error_thrown_by([] { DepthSensor("octurn-simulator://?noize=2"); });

  EXPECT_EQ(error.code(), "sensor-failed");
  EXPECT_STREQ(error.what(), "sensor: simulator: unknown key \"noize\"");
}

TEST(DepthSensor, RefusesABadMeshByItsName) {
  const TemporaryFolder folder;
  const std::string mesh = (folder.path() / "cup.obj").string();
  put(mesh, "v 1 2 nan\nv 1 2 3\nv 4 5 7\nf 1 2 3\n");

  const Error error = error_thrown_by([&] { DepthSensor("octurn-simulator://" + mesh); });

  EXPECT_EQ(error.code(), "sensor-failed");
  EXPECT_NE(std::string(error.what()).find(mesh), std::string::npos) << error.what();
  EXPECT_FALSE(error.hint().empty());
}

}  // namespace
}  // namespace octurn
