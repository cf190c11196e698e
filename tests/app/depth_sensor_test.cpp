#include "sensor/depth_sensor.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

TEST(DepthSensor, FindsOcturnsDriversAndNotTheSystemsSet) {
  const auto sensor = open_sensor("octurn-simulator://");

  EXPECT_EQ(sensor->name(), "Kinect v1 (simulated)");
  const std::string loaded = content_of("/proc/self/maps");
  EXPECT_NE(loaded.find("/lib/octurn/OpenNI2/Drivers/libOcturnSimulator.so.0"), std::string::npos);
  EXPECT_EQ(loaded.find("libDummyDevice"), std::string::npos);  // a driver of the system's OpenNI2
}

TEST(DepthSensor, FindsNoSimulatedSensorUnlessAskedForIt) {
  EXPECT_TRUE(open_sensor("octurn-simulator://")->read({}).has_value());

  try {
    const auto any = open_sensor("");
    EXPECT_EQ(any->name().find("simulated"), std::string::npos);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::sensor_missing);
    EXPECT_FALSE(error.hint().empty());
  }
}

TEST(DepthSensor, HasTheIntrinsicsOfAKinect) {
  const auto sensor = open_sensor("octurn-simulator://");

  const Intrinsics& intrinsics = sensor->intrinsics();
  EXPECT_EQ(intrinsics.width, 640);
  EXPECT_EQ(intrinsics.height, 480);
  EXPECT_NEAR(intrinsics.fx, 575.8, 1e-3);  // OpenNI2 has fields of view as floats
  EXPECT_NEAR(intrinsics.fy, 575.8, 1e-3);
  EXPECT_EQ(intrinsics.cx, 320);
  EXPECT_EQ(intrinsics.cy, 240);
  EXPECT_EQ(intrinsics.depth_unit, 0.0001);
}

TEST(DepthSensor, StampsFramesByTheSteadyClock) {
  const auto sensor = open_sensor("octurn-simulator://");
  const auto before = steady_clock::now();
  sensor->read({});  // may have come before `before`
  sensor->read({});  // may have begun before
  const auto first = sensor->read({})->time;
  const auto second = sensor->read({})->time;
  EXPECT_GT(first, before);
  EXPECT_GT(second, first);
  EXPECT_LE(second, steady_clock::now());
}

/// The time between the first frame of a stream and the one `periods` later; longer where frames
/// were dropped.
steady_clock::duration time_of_periods(int periods, const std::string& speed) {
  const auto sensor = open_sensor("octurn-simulator://?speed=" + speed);
  const auto first = sensor->read({})->time;
  auto last = first;
  for (int i = 0; i < periods; ++i) {
    last = sensor->read({})->time;
  }
  return last - first;
}

// If the first frame is late, the second one seems early by that time, but no later one.
TEST(DepthSensor, SendsThirtyFramesASecondAtMost) {
  EXPECT_GE(time_of_periods(8, "1"), 7 * microseconds(33'333));
}

TEST(DepthSensor, IsSlowerThanLifeIfTold) {
  EXPECT_GE(time_of_periods(4, "0.25"), 3 * microseconds(133'333));
}

TEST(DepthSensor, ReadsNothingWhenStopped) {
  const auto sensor = open_sensor("octurn-simulator://?silent-after=0&speed=0.001");
  std::stop_source stop;
  const std::jthread stopper([&stop] { stop.request_stop(); });

  EXPECT_FALSE(sensor->read(stop.get_token()).has_value());  // the limit of 2 s is half an hour
}

TEST(DepthSensor, SaysThatItIsSilent) {
  const auto sensor = open_sensor("octurn-simulator://?silent-after=2");
  EXPECT_TRUE(sensor->read({}).has_value());
  const auto begin = steady_clock::now();

  const Error error = error_thrown_by([&] {
    while (sensor->read({})) {  // a busy machine may get some frames before the silence
    }
  });

  EXPECT_EQ(error.code(), ErrorCode::sensor_silent);
  EXPECT_STREQ(error.what(), "sensor: no frame for 2000 ms");
  EXPECT_GE(steady_clock::now() - begin,
            milliseconds(1900));  // 2 s by a clock with 30 ticks a second
}

// The limit is sixty frame periods, 20 ms at a hundred times the speed.
TEST(DepthSensor, CountsSilenceByTheClockOfASimulatedSensor) {
  // On a busy machine even the first frame may be later than 20 ms.
  const auto sensor = open_sensor("octurn-simulator://?silent-after=2&speed=100");
  const auto begin = steady_clock::now();
  EXPECT_EQ(code_thrown_by([&] {
              while (sensor->read({})) {
              }
            }),
            "sensor-silent");
  EXPECT_GE(steady_clock::now() - begin, milliseconds(19));
}

TEST(DepthSensor, SaysThatItIsLostAndCanBeOpenedAgain) {
  const char* uri = "octurn-simulator://?lost-after=2";
  {
    const auto sensor = open_sensor(uri);
    EXPECT_TRUE(sensor->read({}).has_value());
    const Error error = error_thrown_by([&] {
      while (sensor->read({})) {
      }
    });
    EXPECT_EQ(error.code(), ErrorCode::sensor_lost);
    EXPECT_FALSE(error.hint().empty());
  }
  const auto again = open_sensor(uri);
  EXPECT_TRUE(again->read({}).has_value());
}

TEST(DepthSensor, RefusesAnUnknownDevice) {
  const Error error = error_thrown_by([] { open_sensor("no-such-device://1"); });

  EXPECT_EQ(error.code(), ErrorCode::sensor_missing);
  EXPECT_NE(std::string(error.what()).find("no-such-device://1"), std::string::npos);
}

// stat fails for such paths: a name too long, or a loop of symbolic links.
TEST(DepthSensor, RefusesAPathThatCannotBeLookedAt) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("loop", folder.path() / "loop");
  for (const std::string& path : {std::string(5000, 'a'), (folder.path() / "loop").string()}) {
    EXPECT_EQ(code_thrown_by([&] { open_sensor(path); }), "sensor-missing");
  }
}

TEST(DepthSensor, RefusesASettingThatTheSimulatorHasNot) {
  const Error error = error_thrown_by([] { open_sensor("octurn-simulator://?noize=2"); });

  EXPECT_EQ(error.code(), ErrorCode::sensor_failed);
  EXPECT_STREQ(error.what(), "sensor: simulator: unknown key \"noize\"");
}

TEST(DepthSensor, RefusesABadMeshByItsName) {
  const TemporaryFolder folder;
  const std::string mesh = (folder.path() / "cup.stl").string();
  put(mesh, "solid cup\nfacet normal 0 0 1\nouter loop\nvertex 1 2 nan\n");

  const Error error = error_thrown_by([&] { open_sensor("octurn-simulator://" + mesh); });

  EXPECT_EQ(error.code(), ErrorCode::sensor_failed);
  EXPECT_NE(std::string(error.what()).find(mesh), std::string::npos) << error.what();
  EXPECT_FALSE(error.hint().empty());
}

}  // namespace
}  // namespace octurn
