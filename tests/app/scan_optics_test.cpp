// The optics of a depth sensor: solved by a turn, kept, and used by later scans.

#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "app/scanner_fixture.hpp"
#include "calibration/optics_files.hpp"
#include "octurn/scan_folder.hpp"
#include "sensor/wrapped_sensor.hpp"

namespace octurn {
namespace {

constexpr double wrong_focal = 592;  // pixels; the simulated sensor renders with 575.8

/// A simulated sensor whose data sheet is wrong.
class SensorOfWrongOptics final : public WrappedSensor {
 public:
  explicit SensorOfWrongOptics(std::unique_ptr<DepthSensor> sensor)
      : WrappedSensor(std::move(sensor)), reported_(WrappedSensor::intrinsics()) {
    reported_.fx = wrong_focal;
    reported_.fy = wrong_focal;
  }

  const Intrinsics& intrinsics() const override { return reported_; }

 private:
  Intrinsics reported_;
};

OpticsRecord some_optics() {
  return {.optics = {.value = {.fx = 580, .fy = 580, .cx = 322, .cy = 241, .k1 = -0.02},
                     .sigma = {.fx = 1, .fy = 1}},
          .at = "2026-11-28T08:00:00Z"};
}

class ScanOptics : public ScannerTest {
 protected:
  /// Without the pattern, which without a map would hide all but the focal length, and without
  /// noise, for which the simulated object is too simple.
  static RigOptions wrong_rig() {
    RigOptions options{.sensor_uri = "octurn-simulator://?speed=50&pattern=0&noise=0", .speed = 50};
    options.open_sensor = [](const std::string& uri) {
      return std::make_unique<SensorOfWrongOptics>(open_sensor(uri));
    };
    return options;
  }

  Scan stored(const Job& job) const { return read_scan(store_.folder(job.id)); }
};

TEST_F(ScanOptics, OfATurnAreKeptForTheNextScan) {
  Scanner scanner(wrong_rig(), {}, store_);
  ScanSettings settings = scanner.calibration().in_force(few_snapshots(24));
  ASSERT_TRUE(scanner.calibrate(settings));
  scanner.wait_until_done(patience);
  const CalibrationRun run = **scanner.calibration_run();
  ASSERT_EQ(run.state, CalibrationRun::State::done) << run.report->calibration.reason;
  ASSERT_TRUE(run.report->calibration.optics_differ);
  const auto kept = read_optics(store_.data(), "simulated-1-perfect");
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept.front().origin, OpticsOrigin::turn);
  EXPECT_NEAR(kept.front().optics.value.fx, 575.8, 3 * kept.front().optics.sigma.fx);
  EXPECT_EQ(scanner.known_sensor()->optics.size(), 1U);

  settings = scanner.calibration().in_force(few_snapshots(6));
  settings.pose = PoseSource::configured;  // else it might know them better
  const Scan scan = stored(ScannerTest::scan(scanner, settings));
  ASSERT_TRUE(scan.optics);
  EXPECT_EQ(scan.optics->value, kept.front().optics.value);
  EXPECT_EQ(scan.optics->sigma, kept.front().optics.sigma);
  EXPECT_EQ(scan.intrinsics.fx, wrong_focal) << "as the sensor reports";
  EXPECT_FALSE(scan.solved && scan.solved->optics);

  EXPECT_EQ(scanner.calibration().records({}).front().optics_at, kept.front().at);
  ASSERT_TRUE(scanner.undo_optics());
  EXPECT_TRUE(scanner.known_sensor()->optics.empty());
  EXPECT_EQ(scanner.calibration().records({}).front().origin, PoseOrigin::drawing)
      << "the pose was solved with the optics";
  EXPECT_FALSE(optics_in_force(store_.data(), "simulated-1-perfect"));
}

TEST_F(ScanOptics, OfAScanAreKeptForTheNextOne) {
  Scanner scanner(wrong_rig(), {}, store_);
  const Scan first = stored(ScannerTest::scan(scanner, few_snapshots(24)));
  EXPECT_FALSE(first.optics) << "nobody knew them";
  ASSERT_TRUE(first.solved && first.solved->optics);
  const auto kept = read_optics(store_.data(), "simulated-1-perfect");
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept.front().origin, OpticsOrigin::scan);
  EXPECT_EQ(kept.front().optics.value, first.solved->optics->value);
}

TEST_F(ScanOptics, HaveTheScaleInPlaceOfTheDepthUnit) {
  keep_optics(store_.data(), "simulated-1", some_optics());
  Scanner scanner(rig(), {}, store_);
  ScanSettings settings = few_snapshots();
  settings.depth_scale = 1.02;
  const Scan scan = stored(ScannerTest::scan(scanner, settings));
  ASSERT_TRUE(scan.optics);
  EXPECT_EQ(scan.optics->value.depth_scale, 1.02);
  EXPECT_LT(scan.scale_sigma, 0.002) << "a length told it";
  EXPECT_EQ(scan.intrinsics.depth_unit, Intrinsics{}.depth_unit);
  EXPECT_NEAR(model_intrinsics(scan, scan.shots.front()).depth_unit, 1.02 * Intrinsics{}.depth_unit,
              1e-12);
}

TEST_F(ScanOptics, OfAScanThatGoesOnAreThoseThatItWasBegunWith) {
  keep_optics(store_.data(), "simulated-1", some_optics());
  Scanner scanner(rig(), {}, store_);
  const Job started = *scanner.start(few_snapshots(12));
  wait_for_snapshots(scanner, 2);
  scanner.pause(started.id);
  ASSERT_EQ(scanner.wait_until_done(patience).job->state, JobState::paused);
  ASSERT_TRUE(scanner.undo_optics());
  ASSERT_TRUE(scanner.resume(started.id));
  const Job ended = *scanner.wait_until_done(patience).job;
  EXPECT_EQ(ended.state, JobState::finished) << (ended.failure ? ended.failure->detail : "");
  EXPECT_EQ(stored(ended).optics->value, some_optics().optics.value);
}

TEST_F(ScanOptics, ThatAreFarOffAreSolvedAgain) {
  keep_optics(store_.data(), "simulated-1-perfect",
              {.optics = {.value = {.fx = 585, .fy = 585, .cx = 320, .cy = 240},
                          .sigma = {.fx = 9, .fy = 9, .cx = 5, .cy = 5, .k1 = 0.05}},
               .at = "2026-11-28T08:00:00Z"});
  Scanner scanner(wrong_rig(), {}, store_);
  ScanSettings settings = few_snapshots(24);
  settings.depth_scale = 1.01;
  const Job job = ScannerTest::scan(scanner, settings);
  const Scan scan = stored(job);
  ASSERT_TRUE(scan.solved && scan.solved->optics);
  EXPECT_EQ(scan.solved->optics->value.depth_scale, 1.01);
  const auto kept = read_optics(store_.data(), "simulated-1-perfect");
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_NEAR(kept.front().optics.value.fx, 575.8, 3 * kept.front().optics.sigma.fx);
  EXPECT_EQ(kept.front().optics.value.depth_scale, 1) << "the length is kept with the pose";
  ASSERT_TRUE(job.calibration && job.calibration->optics);
  EXPECT_EQ(job.calibration->optics->value, scan.solved->optics->value);
  ASSERT_TRUE(job.model && job.model->quality && job.model->quality->size_error);
  EXPECT_LT(job.model->quality->size_error->error, 0.01 * job.model->quality->size_error->length);
}

}  // namespace
}  // namespace octurn
