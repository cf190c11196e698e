// A rig with lasers that calibrates itself by a turn or a scan, and stores the result.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/scanner_fixture.hpp"
#include "app/simulated_laser_rig.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr double speed = 200;
constexpr double turned = 0.4;  // degrees: 2.4 mm at the object

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees_from_radians(std::atan2(a.cross(b).norm(), a.dot(b)));
}

class LaserCalibrationOfARig : public ::testing::Test {
 protected:
  static ScanSettings settings(int stops) {
    ScanSettings few;
    use_laser_capture_defaults(few);
    few.snapshots = stops;
    few.leaf_size = 0.004;
    return few;
  }

  CalibrationRun turn(Scanner& scanner) {
    EXPECT_TRUE(scanner.calibrate(settings(24)));
    EXPECT_FALSE(scanner.wait_until_done(patience).busy());
    return **scanner.calibration_run();
  }

  /// Runs a scan to its end. @return the content of its folder
  Scan scan(Scanner& scanner, const ScanSettings& settings) {
    EXPECT_TRUE(scanner.start(settings));
    const Job job = *scanner.wait_until_done(patience).job;
    EXPECT_EQ(job.state, JobState::finished) << job.failure->detail;
    return read_scan(store_.folder(job.id));
  }

  Eigen::Vector3d told_left() const { return told_.left.laser.normal; }
  Eigen::Vector3d true_left() const {
    const Eigen::Vector3d up =
        told_.platform_from_sensor.linear().transpose() * Eigen::Vector3d::UnitZ();
    return turned_in_holder(told_.left.laser, up, rig_.left_turn).normal;
  }

  TemporaryFolder folder_ = {};
  ScanStore store_{folder_.path()};
  LaserSettings told_ = small_laser_settings();
  SimulatedLaserRig rig_ = SimulatedLaserRig();
};

TEST_F(LaserCalibrationOfARig, FindsATurnedLaserWithATurnAndTellsItTheNextScan) {
  rig_.left_turn = radians_from_degrees(turned);
  Scanner scanner(rig_.options(speed), {}, store_);
  const CalibrationRun run = turn(scanner);
  ASSERT_EQ(run.state, CalibrationRun::State::done);
  ASSERT_EQ(run.report->lasers.size(), 2U);
  const Laser& left = run.report->lasers.front();
  EXPECT_LT(angle_deg(left.normal, true_left()), turned / 4);
  EXPECT_LT(angle_deg(run.report->lasers[1].normal, told_.right.laser.normal), turned / 4);
  EXPECT_GT(run.report->before.size(), 100U);
  EXPECT_GT(run.report->after.size(), 100U);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "calibration-turn"));

  const PoseRecord kept = scanner.calibration().records({}).front();
  EXPECT_EQ(kept.origin, PoseOrigin::turn);
  EXPECT_EQ(kept.camera, "simulated-laser");
  ScanSettings next = settings(4);
  next.pose = PoseSource::configured;
  const Scan scanned = scan(scanner, next);
  EXPECT_EQ(scanned.laser->lasers[0].normal, left.normal);
  EXPECT_EQ(scanned.laser->lasers[0].distance, left.distance);
  EXPECT_EQ(scanned.platform_from_sensor.matrix(), kept.platform_from_sensor.matrix());
  EXPECT_TRUE(scanned.laser->lasers[0].source);
}

TEST_F(LaserCalibrationOfARig, SaysThatTheLasersDisagreeWhereAWeakMotorLostSteps) {
  RigOptions weak = rig_.options(speed);
  weak.load = PlatformLoad{.holding_torque = 0.05, .inertia = 0.013};
  Scanner scanner(std::move(weak), {}, store_);
  scan(scanner, settings(24));
  const Job job = *scanner.status().job;
  EXPECT_FALSE(job.calibration->accepted);
  ASSERT_FALSE(job.model->quality->reasons.empty());
  const QualityReason& first = job.model->quality->reasons.front();
  EXPECT_EQ(first.code, "stops-disagree");
  EXPECT_NE(first.detail.find("the motor lost steps"), std::string::npos);
}

TEST_F(LaserCalibrationOfARig, RemembersAcrossAStartWhatAScanHasSolved) {
  rig_.left_turn = radians_from_degrees(turned);
  Eigen::Vector3d solved;
  {
    Scanner scanner(rig_.options(speed), {}, store_);
    const Scan first = scan(scanner, settings(24));
    EXPECT_EQ(first.laser->lasers[0].normal, told_left());
    ASSERT_TRUE(first.solved);
    solved = first.solved->lasers[0].normal;
    EXPECT_LT(angle_deg(solved, true_left()), turned / 4);
  }
  Scanner scanner(rig_.options(speed), {}, store_);
  EXPECT_EQ(scanner.calibration().records({}).front().origin, PoseOrigin::scan);
  ScanSettings next = settings(4);
  next.pose = PoseSource::configured;
  EXPECT_EQ(scan(scanner, next).laser->lasers[0].normal, solved);
}

TEST_F(LaserCalibrationOfARig, StaysAsItIsWhereTheNextScanAgrees) {
  rig_.left_turn = radians_from_degrees(turned);
  Scanner scanner(rig_.options(speed), {}, store_);
  scan(scanner, settings(24));
  const std::vector<PoseRecord> first = scanner.calibration().records({});
  const Scan second = scan(scanner, settings(24));
  EXPECT_FALSE(second.solved);
  EXPECT_TRUE(scanner.status().job->calibration->accepted);
  EXPECT_TRUE(scanner.status().job->calibration->confirms_told);
  EXPECT_EQ(scanner.calibration().records({}).size(), first.size());
  EXPECT_EQ(second.laser->lasers[0].normal, first.front().lasers[0].normal);
}

TEST_F(LaserCalibrationOfARig, IsOfItsOwnCamera) {
  Scanner scanner(rig_.options(speed), {}, store_);
  const Laser another{.name = "left", .normal = Eigen::Vector3d::UnitX(), .distance = 0.1};
  scanner.calibration().set(to_record(CalibrationReport{}, PoseOrigin::turn, "other", {another}));
  ScanSettings next = settings(4);
  next.pose = PoseSource::configured;
  EXPECT_EQ(scan(scanner, next).laser->lasers[0].normal, told_left());
}

TEST_F(LaserCalibrationOfARig, StaysAsItIsWhereATurnIsRefused) {
  rig_.other_pose = told_.platform_from_sensor;
  rig_.other_pose->translation().z() += 0.02;  // the platform lies 20 mm too low
  rig_.other_pose->rotate(Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitZ()));
  Scanner scanner(rig_.options(speed), {}, store_);
  const CalibrationRun run = turn(scanner);
  ASSERT_EQ(run.state, CalibrationRun::State::refused);
  EXPECT_FALSE(run.report->calibration.reason.empty());
  ScanSettings told;
  told.platform_from_sensor = told_.platform_from_sensor;
  EXPECT_EQ(scanner.calibration().records(told).front().origin, PoseOrigin::drawing);
}

TEST_F(LaserCalibrationOfARig, EndsWithItsLasersOffWhenATurnIsCancelled) {
  Scanner scanner(rig_.options(speed), {}, store_);
  rig_.on_picture([&](SimulatedLaserRig& rig) {
    if (rig.is_lit()) {
      scanner.cancel_calibration();
    }
  });
  const CalibrationRun run = turn(scanner);
  EXPECT_EQ(run.state, CalibrationRun::State::cancelled);
  EXPECT_FALSE(rig_.is_lit());
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "calibration-turn"));
}

TEST(LaserRig, SaysWhatNeedsADepthSensorInstead) {
  SimulatedLaserRig simulated;
  Rig rig(simulated.options(speed));
  const Error error = error_thrown_by([&] { rig.sensor(); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_other);
  EXPECT_NE(error.hint().find("be calibrated"), std::string::npos) << error.hint();
}

}  // namespace
}  // namespace octurn
