// Whole runs of the program on an emulated Kinect that is fed with the simulated one's view.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <thread>

#include "kinect/kinect_on_desk.hpp"
#include "kinect/kinect_view.hpp"
#include "kinect/lossy_wire.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "sensor/recording.hpp"
#include "support/program.hpp"
#include "support/stl.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// Expects equal depths up to rounding and a unit in the last digit of the constants.
void expect_same_depths(const DepthFrame& one, const DepthFrame& other) {
  ASSERT_EQ(one.depth.size(), other.depth.size());
  for (std::size_t i = 0; i < one.depth.size(); ++i) {
    const double depth = other.depth[i];
    ASSERT_NEAR(one.depth[i], depth, 1 + depth * depth * 1e-8) << i;
  }
}

std::vector<std::string> command(const char* name, const fs::path& output, const char* sensor,
                                 std::vector<std::string> more) {
  std::vector<std::string> words{
      octurn_program(), name, "--simulate", "--simulate-speed", "20", "--sensor",
      sensor,           "-o", output,       "--frames",         "2"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(KinectScan, MakesAClosedModel) {
  const DepthFrame seen = simulated_frame();
  const KinectOnDesk desk({readings_of(seen)});
  const TemporaryFolder folder;
  Program scan(
      command("scan", folder.path() / "Scan.stl", "kinect://",
              {"--snapshots", "3", "--leaf-size-mm", "4", "--data", folder.path() / "data"}));
  ASSERT_EQ(scan.wait(), 0) << scan.errors();

  const std::string stl = content_of(folder.path() / "Scan.stl");
  EXPECT_GT(triangles_of_whole_stl(stl), 1000);
  EXPECT_EQ(open_edges(stl), 0);
  const fs::path scans = folder.path() / "data" / "scans";
  const fs::path stored = fs::directory_iterator(scans)->path();
  const Scan kept = read_scan(stored);
  EXPECT_EQ(kept.sensor_name, "Kinect v1");
  ASSERT_EQ(kept.shots.size(), 3);
  expect_same_depths(read_snapshot(stored, kept, kept.shots[1]).frame, seen);
}

class LossyKinectScan : public ::testing::TestWithParam<LossyWire> {};

// Pixels that a frame lost are taken from others of the stop: no reading may be missing.
TEST_P(LossyKinectScan, MakesTheSameModelAsOnAWireThatIsWell) {
  KinectOnDesk desk({readings_of(simulated_frame())});
  const TemporaryFolder folder;
  const auto scan = [&](const std::string& name) {
    Program program(
        command("scan", folder.path() / (name + ".stl"), "kinect://",
                {"--snapshots", "8", "--leaf-size-mm", "4", "--data", folder.path() / name}));
    EXPECT_EQ(program.wait(), 0) << program.errors();
    return content_of(folder.path() / (name + ".stl"));
  };
  const std::string whole = scan("whole");
  desk->random_loss = GetParam().random_loss;
  desk->burst = GetParam().burst;
  EXPECT_TRUE(scan("lossy") == whole);

  const auto lost_share_of = [&](const char* name) {
    const fs::path scans = folder.path() / name / "scans";
    double sum = 0;
    for (const Shot& shot : read_scan(fs::directory_iterator(scans)->path()).shots) {
      sum += shot.lost_share / 8;
    }
    return sum;
  };
  EXPECT_EQ(lost_share_of("whole"), 0);
  const double expected = GetParam().random_loss + GetParam().burst / 7283.0;
  // A stop has some 500 packets, and a burst comes only about once a second.
  EXPECT_NEAR(lost_share_of("lossy"), expected, GetParam().burst > 0 ? 0.1 : expected / 2);
}

INSTANTIATE_TEST_SUITE_P(Each, LossyKinectScan, ::testing::ValuesIn(lossy_wires));

TEST(KinectScan, PausesWhenTheKinectIsUnpluggedAndGoesOnWhenItIsBack) {
  KinectOnDesk desk({readings_of(simulated_frame())});
  const TemporaryFolder folder;
  std::vector<std::string> words =
      command("scan", folder.path() / "Scan.stl", "kinect://",
              {"--snapshots", "12", "--leaf-size-mm", "4", "--data", folder.path() / "data"});
  const fs::path scans = folder.path() / "data" / "scans";
  for (int status = 0; status == 0;) {  // once more where the scan ended before it was unplugged
    fs::remove_all(folder.path() / "data");
    desk.plug_in();
    Program scan(words);
    while (desk->frames_sent < 5 || !fs::exists(scans) || fs::is_empty(scans)) {
      std::this_thread::yield();
    }
    desk.unplug();
    status = scan.wait();
    EXPECT_TRUE(status == 0 ||
                scan.errors().find("kinect: none is plugged in") != std::string::npos)
        << scan.errors();
  }

  desk.plug_in();
  const fs::path stored = fs::directory_iterator(scans)->path();
  words.insert(words.end(), {"--resume", stored.filename()});
  Program resumed(words);
  EXPECT_EQ(resumed.wait(), 0) << resumed.errors();
  EXPECT_EQ(read_scan(stored).shots.size(), 12U);
}

TEST(KinectScan, IsRecordedWithTimesAnglesAndTilt) {
  const DepthFrame seen = simulated_frame();
  KinectOnDesk desk({readings_of(seen)});
  desk->acceleration[2] = -819;
  const TemporaryFolder folder;
  Program record(command("record", folder.path() / "turn", "kinect://", {"--snapshots", "2"}));
  ASSERT_EQ(record.wait(), 0) << record.errors();

  const Recording recording = read_recording(folder.path() / "turn");
  EXPECT_EQ(recording.sensor_name, "Kinect v1");
  ASSERT_EQ(recording.frames.size(), 4);
  EXPECT_EQ(recording.frames[0].time.count(), 0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(recording.frames[i].angle, radians_from_degrees(i < 2 ? 0 : 180), 1e-12);
    EXPECT_NEAR(recording.frames[i].tilt->pitch, radians_from_degrees(-45), 1e-9);
    if (i > 0) {
      EXPECT_GT(recording.frames[i].time, recording.frames[i - 1].time);
    }
    expect_same_depths(read_recorded_frame(folder.path() / "turn", recording, i), seen);
  }
}

}  // namespace
}  // namespace octurn
