#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <thread>
#include <utility>

#include "app/scanner_fixture.hpp"
#include "app/simulated_frames.hpp"
#include "app/wrapped_sensor.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

TEST_F(ScannerTest, OpensASensorAgainThatFellSilent) {
  RigOptions options = rig();
  std::atomic<bool> is_seen = false;
  options.open_sensor = [&, is_first = true](const std::string& uri) mutable {
    if (std::exchange(is_first, false)) {
      return std::unique_ptr<DepthSensor>(std::make_unique<SensorSilentOnceTurned>(uri));
    }
    is_seen.wait(false);
    return open_sensor(uri);
  };
  Scanner scanner(options, {}, store_);
  scanner.start(few_snapshots());
  const Status silent = wait_until(scanner, [](const Status& status) {
    return status.job->failure.has_value() || !status.busy();
  });
  is_seen = true;
  is_seen.notify_all();
  EXPECT_TRUE(silent.busy());
  EXPECT_EQ(silent.job->failure->code, ErrorCode::sensor_silent);
  ASSERT_TRUE(silent.job->times.until_pause);
  EXPECT_LE(*silent.job->times.until_pause, 30s);
  const Status status = scanner.wait_until_done(patience);
  EXPECT_EQ(status.job->state, JobState::finished);
  EXPECT_FALSE(status.job->failure);
  EXPECT_FALSE(status.job->times.until_pause);
  EXPECT_EQ(status.sensor.state, DeviceStatus::State::ready);
}

TEST_F(ScannerTest, SaysThatThereIsNoSensor) {
  Scanner scanner({.sensor_uri = "/nowhere.oni", .speed = 20}, {}, store_);
  const Status status = wait_until(
      scanner, [](const Status& s) { return s.sensor.state != DeviceStatus::State::unknown; });
  EXPECT_EQ(status.sensor.state, DeviceStatus::State::missing);
  EXPECT_EQ(code_thrown_by([&] { scanner.camera_frame(); }), "sensor-missing");
  EXPECT_EQ(code_thrown_by([&] { scanner.expect_ready(); }), "sensor-missing");
  const Job job = scan(scanner, few_snapshots());
  EXPECT_EQ(job.state, JobState::paused);
  EXPECT_EQ(job.failure->code, ErrorCode::sensor_missing);
}

/// Kinds of exceptions other than Error that a driver may throw.
enum class Thrown { exception, number };

[[noreturn]] void throw_one(Thrown thrown) {
  if (thrown == Thrown::number) {
    throw 5;  // NOLINT: a foreign library may throw anything
  }
  throw std::runtime_error("no such thing: \xff");
}

TEST_F(ScannerTest, TakesWhateverASensorThrowsAsItsFailure) {
  for (const Thrown thrown : {Thrown::exception, Thrown::number}) {
    RigOptions options = rig();
    options.open_sensor = [=](const std::string&) -> std::unique_ptr<DepthSensor> {
      throw_one(thrown);
    };
    Scanner scanner(options, {}, store_);
    const Status status = wait_until(
        scanner, [](const Status& s) { return s.sensor.state == DeviceStatus::State::failed; });
    EXPECT_EQ(status.sensor.failure.code, ErrorCode::internal);
    const Job job = scan(scanner, few_snapshots());
    EXPECT_EQ(job.state, JobState::failed);
    EXPECT_EQ(store_.find(job.id)->state, JobState::failed);
  }
}

TEST_F(ScannerTest, TakesWhateverATurntableThrowsAsItsFailure) {
  RigOptions options = rig();
  options.stepper = StepperSettings{};
  options.open_lines = [](const StepperSettings&) -> Stepper::SetLine {
    throw_one(Thrown::exception);
  };
  Scanner scanner(options, {}, store_);
  const Status status = wait_until(
      scanner, [](const Status& s) { return s.turntable.state == DeviceStatus::State::failed; });
  EXPECT_EQ(status.turntable.failure.code, ErrorCode::internal);
  EXPECT_EQ(scan(scanner, few_snapshots()).state, JobState::failed);
}

TEST_F(ScannerTest, TakesStopsAgainToWhichAWeakMotorLostSteps) {
  RigOptions options = rig();
  options.load = PlatformLoad{.holding_torque = 0.05, .inertia = 0.013};
  Scanner scanner(options, {}, store_);
  ScanSettings settings;
  settings.snapshots = 24;
  const Job job = scan(scanner, settings);
  EXPECT_EQ(job.state, JobState::finished);
  EXPECT_GT(job.times.slips, 0);
  EXPECT_GT(job.times.settling.count(), 0) << "such a platform swings";
  const JobTimes stored = store_.find(job.id)->times;
  EXPECT_EQ(stored.slips, job.times.slips);
  EXPECT_NEAR(stored.settling.count(), job.times.settling.count(), 1e-3);
}

TEST_F(ScannerTest, DoesNotTakeAWrongPoseForLostSteps) {
  RigOptions options = rig();
  options.load = PlatformLoad{};
  Scanner scanner(options, {}, store_);
  ScanSettings settings;
  settings.snapshots = 24;
  settings.filter = DepthFilter::basic;
  settings.pose = PoseSource::configured;
  settings.platform_from_sensor =
      Eigen::Translation3d(0.012, -0.016, 0) *
      Eigen::AngleAxisd(radians_from_degrees(2.0), Eigen::Vector3d::UnitX()) *
      settings.platform_from_sensor;
  const Job job = scan(scanner, settings);
  EXPECT_EQ(job.state, JobState::finished);
  EXPECT_EQ(job.times.slips, 0);
}

/// An STL of a round cup, 8 cm wide and 9.5 cm tall.
std::string round_cup() {
  constexpr int sides = 96;
  const auto vertex = [](double radius, int side, double z) {
    const double angle = 2 * std::numbers::pi * side / sides;
    return "vertex " + std::to_string(radius * std::cos(angle)) + " " +
           std::to_string(radius * std::sin(angle)) + " " + std::to_string(z) + "\n";
  };
  std::string stl = "solid cup\n";
  const auto quad = [&](double r0, double z0, double r1, double z1) {
    for (int i = 0; i < sides; ++i) {
      stl += "facet normal 0 0 0\nouter loop\n" + vertex(r0, i, z0) + vertex(r0, i + 1, z0) +
             vertex(r1, i + 1, z1) + "endloop\nendfacet\nfacet normal 0 0 0\nouter loop\n" +
             vertex(r0, i, z0) + vertex(r1, i + 1, z1) + vertex(r1, i, z1) + "endloop\nendfacet\n";
    }
  };
  quad(0, 0, 40, 0);
  quad(40, 0, 40, 95);
  quad(40, 95, 36, 95);
  quad(36, 95, 36, 5);
  quad(36, 5, 0, 5);
  return stl + "endsolid\n";
}

TEST_F(ScannerTest, DoesNotTakeARoundObjectForLostSteps) {
  put(folder_.path() / "cup.stl", round_cup());
  RigOptions options = rig();
  options.sensor_uri =
      simulation_uri({.mesh_file = folder_.path() / "cup.stl", .unit = 1, .speed = 20});
  options.load = PlatformLoad{};
  Scanner scanner(options, {}, store_);
  ScanSettings settings;
  settings.filter = DepthFilter::basic;
  const Job job = scan(scanner, settings);
  EXPECT_EQ(job.state, JobState::finished);
  EXPECT_EQ(job.times.slips, 0);
}

TEST_F(ScannerTest, ShowsASensorsFaultWhateverItsCode) {
  RigOptions options = rig();
  options.open_sensor = [](const std::string&) -> std::unique_ptr<DepthSensor> {
    throw Error(ErrorCode::recording_malformed, "recording.json: is missing");
  };
  Scanner scanner(options, {}, store_);
  EXPECT_EQ(code_thrown_by([&] { scanner.camera_frame(); }), "recording-malformed");
  EXPECT_EQ(scanner.status().sensor.failure.detail, "recording.json: is missing");
}

TEST_F(ScannerTest, SaysThatThereIsNoTurntable) {
  RigOptions options = rig();
  options.stepper = StepperSettings{};
  options.open_lines = [](const StepperSettings&) -> Stepper::SetLine {
    throw Error(ErrorCode::turntable_missing, "this machine has no GPIO header");
  };
  Scanner scanner(options, {}, store_);
  const Status status = wait_until(scanner, [](const Status& now) {
    return now.turntable.state != DeviceStatus::State::unknown;
  });
  EXPECT_EQ(status.turntable.state, DeviceStatus::State::missing);
  EXPECT_FALSE(status.turntable.simulated);
  EXPECT_NE(status.turntable.failure.detail.find("GPIO"), std::string::npos)
      << status.turntable.failure.detail;
  EXPECT_EQ(code_thrown_by([&] { scanner.expect_ready(); }), "turntable-missing");
}

TEST_F(ScannerTest, ShowsWhatTheSensorSeesNow) {
  Scanner scanner(rig(), {}, store_);
  const auto first = scanner.camera_frame();
  EXPECT_EQ(first->frame.width, 640);
  EXPECT_GT(std::ranges::count_if(first->frame.depth, [](auto depth) { return depth > 0; }),
            100'000);
  EXPECT_GT(scanner.camera_frame()->time, first->time - 1ms);
}

TEST_F(ScannerTest, ShowsWhatItSawLastDuringAScan) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 1);
  ASSERT_TRUE(scanner.start(few_snapshots()));
  wait_for_snapshots(scanner, 1);
  EXPECT_EQ(scanner.camera_frame()->frame.height, 480);
  EXPECT_TRUE(scanner.status().busy());
}

// The worker looks every five seconds.
TEST_F(ScannerTest, SwitchesTheSensorOffUnlessItIsKeptOn) {
  RigOptions options = rig();
  options.sensor_off_after = 0s;
  {
    Scanner scanner(options, {}, store_);
    scanner.camera_frame();
    const auto begin = std::chrono::steady_clock::now();
    while (scanner.known_sensor()->since && std::chrono::steady_clock::now() - begin < patience) {
      std::this_thread::sleep_for(100ms);
    }
    EXPECT_FALSE(scanner.known_sensor()->since);
  }
  options.sensor_off_after.reset();
  Scanner warm(options, {}, store_);
  warm.camera_frame();
  std::this_thread::sleep_for(11s);
  EXPECT_TRUE(warm.known_sensor()->since);
  const Job job = scan(warm, few_snapshots());
  const auto on_for = read_scan(store_.folder(job.id)).sensor_on_for;
  ASSERT_TRUE(on_for);
  EXPECT_GE(*on_for, 11);
}

}  // namespace
}  // namespace octurn
