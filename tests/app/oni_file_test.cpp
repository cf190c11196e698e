// Recordings of OpenNI2's own recorder (.oni), opened as the sensor.

#include <OpenNI.h>
#include <gtest/gtest.h>

#include <atomic>
#include <set>
#include <vector>

#include "app/few_snapshots.hpp"
#include "rig/nominal_pose.hpp"
#include "rig/simulation.hpp"
#include "run/run_scan.hpp"
#include "sensor/depth_sensor.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulator_object.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using Depths = std::vector<std::uint16_t>;

/// Counts the frames that arrive, which the recorder also gets.
class FrameCounter final : public openni::VideoStream::NewFrameListener {
 public:
  void wait_for(int count) const {
    for (int seen = count_; seen < count; seen = count_) {
      count_.wait(seen);
    }
  }

 private:
  void onNewFrame(openni::VideoStream& stream) override {
    openni::VideoFrameRef frame;
    stream.readFrame(&frame);
    ++count_;
    count_.notify_all();
  }
  std::atomic<int> count_ = 0;
};

/// Records the simulated Kinect until it has sent so many frames.
void record_while(const std::filesystem::path& file, int frames) {
  load_sensor_drivers();
  openni::Device device;
  ASSERT_EQ(device.open("octurn-simulator://"), openni::STATUS_OK);
  openni::VideoStream stream;
  ASSERT_EQ(stream.create(device, openni::SENSOR_DEPTH), openni::STATUS_OK);
  FrameCounter counter;
  stream.addNewFrameListener(&counter);
  openni::Recorder recorder;
  ASSERT_EQ(recorder.create(file.c_str()), openni::STATUS_OK);
  ASSERT_EQ(recorder.attach(stream), openni::STATUS_OK);
  ASSERT_EQ(recorder.start(), openni::STATUS_OK);
  ASSERT_EQ(stream.start(), openni::STATUS_OK);
  counter.wait_for(frames);
  recorder.stop();
  recorder.destroy();
  stream.removeNewFrameListener(&counter);  // while frames arrive: it may be waiting for one
  stream.stop();
  stream.destroy();
  device.close();
}

int frames_in(const std::filesystem::path& file) {
  openni::Device device;
  openni::VideoStream stream;
  EXPECT_EQ(device.open(file.c_str()), openni::STATUS_OK);
  EXPECT_EQ(stream.create(device, openni::SENSOR_DEPTH), openni::STATUS_OK);
  const int frames = device.getPlaybackControl()->getNumberOfFrames(stream);
  stream.destroy();
  device.close();
  return frames;
}

/// Records at least `frames` frames of the simulated Kinect. The recorder writes them on a thread
/// of its own, and drops those that wait for it when it is stopped: on a busy machine that may be
/// all.
void record_oni(const std::filesystem::path& file, int frames) {
  int sent = frames;
  do {
    ASSERT_LT(sent, 1000 * frames);
    sent *= 2;
    record_while(file, sent);
  } while (frames_in(file) < frames);
}

TEST(OniFile, IsReadFrameForFrameAndBeginsAgain) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "turn.oni";
  record_oni(file, 6);
  const int count = frames_in(file);
  ASSERT_GE(count, 6);

  const auto sensor = open_sensor(file.string());
  EXPECT_NEAR(sensor->intrinsics().fx, 575.8, 1e-3);
  EXPECT_EQ(sensor->intrinsics().depth_unit, 0.0001);
  EXPECT_FALSE(sensor->tilt().has_value());
  std::vector<Depths> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(sensor->read({}).value().frame.depth);
  }
  EXPECT_EQ(std::set<Depths>(frames.begin(), frames.end()).size(), frames.size());  // distinct
  for (const Depths& frame : frames) {
    EXPECT_TRUE(sensor->read({}).value().frame.depth == frame);
  }
}

TEST(OniFile, HoldsTheSensorsDepthsExactly) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "turn.oni";
  record_oni(file, 3);
  const auto recorded = open_sensor(file.string());
  const Depths depths = recorded->read({}).value().frame.depth;
  // The simulator's noise depends on the frame's number, but the first recorded frame's number is
  // not known.
  const Simulation usual;
  const Scene scene(simulator_object(), misaligned_platform_from_sensor(usual.misalignment));
  SimulatedKinect kinect(scene, usual.seed, usual.noise, usual.pattern);
  Depths exposed(depths.size());
  std::uint32_t number = 0;
  while (exposed != depths && number < 1000) {
    kinect.expose(0, ++number, exposed);
  }
  EXPECT_TRUE(exposed == depths);
}

TEST(OniFile, IsScanned) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "turn.oni";
  record_oni(file, 3);
  Rig rig({.sensor_uri = file.string(), .speed = 50});
  const ScanSettings settings = few_snapshots();
  const auto model = run_scan(settings, {}, folder.path() / "scan", *make_capture(rig), {}, {});
  ASSERT_TRUE(model.has_value());
  EXPECT_TRUE(model->report.watertight);
  EXPECT_GT(model->report.triangles, 500);
}

TEST(OniFile, ThatIsNoneIsRefused) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "turn.oni";
  put(file, "no recording");
  const Error error = error_thrown_by([&] { open_sensor(file.string()); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_missing);
  EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
}

}  // namespace
}  // namespace octurn
