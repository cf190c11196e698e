// Scanner::check_devices, and octurn doctor, which uses it.

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "app/few_snapshots.hpp"
#include "app/simulated_laser_rig.hpp"
#include "doctor/doctor.hpp"
#include "doctor/sensor_checks.hpp"
#include "support/patience.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

constexpr const char* fast_sensor = "octurn-simulator://?speed=20";

class CheckDevices : public ::testing::Test {
 protected:
  static RigOptions rig() { return {.sensor_uri = fast_sensor, .speed = 20}; }

  /// Starts a thread that reads the sensor as long as it may. @return the thread, once it reads
  std::thread borrower() {
    std::thread thread([&] {
      scanner_.check_devices([&](Rig& lent, const std::stop_token& stop) {
        while (lent.sensor().read(stop)) {
          is_lent_ = true;
          is_lent_.notify_all();
        }
      });
    });
    is_lent_.wait(false);
    return thread;
  }

  TemporaryFolder folder_;
  std::atomic<bool> is_lent_ = false;
  ScanStore store_{folder_.path()};
  Scanner scanner_{rig(), {}, store_};
};

TEST_F(CheckDevices, LetsTheRigBeUsedBetweenScans) {
  std::string name;
  EXPECT_TRUE(scanner_.check_devices(
      [&](Rig& lent, const std::stop_token& /*stop*/) { name = lent.sensor().name(); }));
  EXPECT_EQ(name, "Kinect v1 (simulated)");
}

TEST_F(CheckDevices, RefusesDuringAScan) {
  ASSERT_TRUE(scanner_.start(few_snapshots(200)));
  EXPECT_FALSE(scanner_.check_devices([](Rig&, const std::stop_token&) { FAIL(); }));
}

TEST_F(CheckDevices, GivesTheRigBackToAScanThatStarts) {
  std::thread borrower = this->borrower();
  EXPECT_TRUE(scanner_.start(few_snapshots()));
  borrower.join();
  EXPECT_EQ(scanner_.wait_until_done(patience).job->state, JobState::finished);
}

TEST_F(CheckDevices, LendsToOneAfterTheOther) {
  std::atomic<int> users = 0;
  std::atomic<int> most = 0;
  const auto use = [&](Rig& lent, const std::stop_token& stop) {
    most = std::max(most.load(), ++users);
    lent.sensor().read(stop);
    --users;
  };
  {
    std::jthread one([&] { EXPECT_TRUE(scanner_.check_devices(use)); });
    std::jthread other([&] { EXPECT_TRUE(scanner_.check_devices(use)); });
  }
  EXPECT_EQ(most, 1);
}

TEST_F(CheckDevices, HandsOnWhatItsUserThrows) {
  EXPECT_THROW(
      scanner_.check_devices([](Rig&, const std::stop_token&) { throw std::runtime_error("no"); }),
      std::runtime_error);
  EXPECT_TRUE(scanner_.check_devices([](Rig&, const std::stop_token&) {}));
}

TEST_F(CheckDevices, EndsWithTheScanner) {
  std::thread borrower = this->borrower();
  scanner_.request_stop();
  borrower.join();
  EXPECT_FALSE(scanner_.check_devices([](Rig&, const std::stop_token&) { FAIL(); }));
}

TEST_F(CheckDevices, LetsTheDoctorLookAtTheSensor) {
  const auto findings = run_checks({.rig = rig(), .config = {.data = folder_.path()}}, scanner_);
  EXPECT_EQ(findings[0].check, "sensor");
  EXPECT_EQ(findings[0].state, Finding::State::ok);
}

TEST(SensorReading, IsASampleOfWhatTheSensorSees) {
  Rig rig({.sensor_uri = fast_sensor});
  const SensorReading look = read_sensor(rig, {});
  ASSERT_TRUE(std::holds_alternative<SensorSample>(look));
  const auto& sample = std::get<SensorSample>(look);
  EXPECT_EQ(sample.times.size(), 60);
  EXPECT_TRUE(std::ranges::is_sorted(sample.times));
  ASSERT_EQ(sample.frames.size(), 10);
  EXPECT_NE(sample.frames[0].depth, sample.frames[9].depth);  // each frame has its own noise
}

TEST(SensorReading, SaysWhyThereIsNoSensor) {
  Rig rig({.sensor_uri = "kinect://7"});
  const SensorReading look = read_sensor(rig, {});
  ASSERT_TRUE(std::holds_alternative<Failure>(look));
  EXPECT_EQ(std::get<Failure>(look).code, ErrorCode::sensor_missing);
}

TEST(SensorReading, TellsWhichLasersACameraSees) {
  SimulatedLaserRig simulated;
  Rig rig(simulated.options(200));
  const auto findings = check_sensor(read_sensor(rig, {}), {}, Eigen::Isometry3d::Identity());
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].state, Finding::State::ok);
  EXPECT_EQ(findings[0].measured,
            "\"Laser line (simulated)\", 410 x 308, sees laser left and right");
  EXPECT_FALSE(simulated.is_lit());
}

TEST(SensorReading, NamesALaserThatGivesNoLight) {
  SimulatedLaserRig simulated;
  simulated.dark_laser = 1;
  Rig rig(simulated.options(200));
  const auto findings = check_sensor(read_sensor(rig, {}), {}, Eigen::Isometry3d::Identity());
  EXPECT_EQ(findings[0].state, Finding::State::fault);
  EXPECT_NE(findings[0].measured.find("laser right"), std::string::npos) << findings[0].measured;
  EXPECT_FALSE(simulated.is_lit());
}

TEST(SensorReading, IsBusyIfItIsStopped) {
  Rig rig({.sensor_uri = fast_sensor});
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(std::get<Failure>(read_sensor(rig, stop.get_token())).code, ErrorCode::busy);
}

}  // namespace
}  // namespace octurn
