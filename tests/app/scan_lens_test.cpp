// The lens of a camera with lasers: found from a board, kept, and used by scans.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <optional>
#include <utility>

#include "app/scanner_fixture.hpp"
#include "app/simulated_laser_rig.hpp"
#include "calibration/board_pdf.hpp"
#include "calibration/optics_files.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "run/scanner.hpp"
#include "simulator/sensor_unit.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr double board_speed = 200;
constexpr double square = metres_from_mm(board_square_mm);

ScanSettings few_stops() {
  ScanSettings few;
  use_laser_capture_defaults(few);
  few.snapshots = 6;
  few.leaf_size = 0.004;
  few.pose = PoseSource::configured;
  return few;
}

class ScanLens : public ::testing::Test {
 protected:
  ScanLens() {
    rig_.other_lens = told_lens(settings_);
    rig_.other_lens->intrinsics.fx *= 1.01;
    rig_.other_lens->intrinsics.cx += 4;
    rig_.other_lens->k1 = -0.05;
  }

  /// A smaller picture, so that a test takes seconds; the board's squares are still wide enough.
  static LaserSettings smaller() {
    LaserSettings settings;
    settings.lens = {.width = 600, .height = 450, .fx = 500, .fy = 500, .cx = 299.5, .cy = 224.5};
    return settings;
  }

  static CalibrationRun ended(Scanner& scanner) {
    EXPECT_FALSE(scanner.wait_until_done(5 * patience).busy());  // it renders and solves for long
    return **scanner.calibration_run();
  }

  static Job scanned(Scanner& scanner, const ScanSettings& settings) {
    scanner.start(settings);
    const Status status = scanner.wait_until_done(patience);
    EXPECT_FALSE(status.busy());
    return *status.job;
  }

  /// Calls `action` once, before the first picture after `count` views of the board, on the thread
  /// that takes them: no further view comes before.
  void after_views(const Scanner& scanner, int count, const std::function<void()>& action) {
    rig_.on_picture([=, &scanner, is_done = false](SimulatedLaserRig&) mutable {
      const std::optional<CalibrationRun> run = *scanner.calibration_run();
      if (run && run->stop >= count && !std::exchange(is_done, true)) {
        action();
      }
    });
  }

  Scan stored(const Job& job) const { return read_scan(store_.folder(job.id)); }

  LaserSettings settings_ = smaller();
  SimulatedLaserRig rig_{settings_};
  TemporaryFolder folder_;
  ScanStore store_{folder_.path()};
};

TEST_F(ScanLens, IsFoundFromABoardKeptAndUsedByTheNextScan) {
  Scanner scanner(rig_.options(board_speed), {}, store_);
  ASSERT_TRUE(scanner.look_at_board(square));
  const CalibrationRun run = ended(scanner);
  ASSERT_EQ(run.state, CalibrationRun::State::done) << (run.failure ? run.failure->detail
                                                        : run.lens  ? run.lens->reason
                                                                    : "");
  const Intrinsics& found = run.lens->lens.intrinsics;
  const Intrinsics& truth = rig_.other_lens->intrinsics;
  EXPECT_NEAR(found.fx, truth.fx, 0.001 * truth.fx);
  EXPECT_NEAR(found.cx, truth.cx, 0.5);
  EXPECT_NEAR(run.lens->lens.k1, -0.05, 0.003);
  EXPECT_EQ(rig_.log().find_first_of("AB"), std::string::npos) << "no laser is on";

  ASSERT_TRUE(scanner.start(few_stops()));
  EXPECT_EQ(error_thrown_by([&] { scanner.keep_lens({}); }).code(), ErrorCode::busy);
  const Scan before = stored(*scanner.wait_until_done(patience).job);
  EXPECT_EQ(before.intrinsics.fx, settings_.lens.fx) << "nobody has kept it yet";
  scanner.keep_lens({});
  EXPECT_FALSE(*scanner.calibration_run());
  EXPECT_TRUE(scanner.known_sensor()->lens);
  const Scan after = stored(scanned(scanner, few_stops()));
  EXPECT_NEAR(after.intrinsics.fx, found.fx, 1e-6);
  EXPECT_NEAR(after.laser->k1, run.lens->lens.k1, 1e-9);

  scanner.forget_lens();
  EXPECT_FALSE(scanner.known_sensor()->lens);
  EXPECT_FALSE(find_lens(store_.data(), "simulated-laser"));
}

TEST_F(ScanLens, OfAScanThatGoesOnIsTheOneItWasBegunWith) {
  Scanner scanner(rig_.options(board_speed), {}, store_);
  rig_.on_picture([&](SimulatedLaserRig& rig) {
    if (std::ranges::count(rig.log(), 'B') == 2) {  // at the second stop
      scanner.pause(scanner.status().job->id);
    }
  });
  const Job paused = scanned(scanner, few_stops());
  ASSERT_EQ(paused.state, JobState::paused);
  rig_.on_picture([](SimulatedLaserRig&) {});

  LensReport other{.accepted = true, .views = 12, .corners = 1000, .rms = 0.1};
  other.lens = *rig_.other_lens;
  keep_lens(store_.data(), "simulated-laser", other);
  ASSERT_TRUE(scanner.resume(paused.id));
  EXPECT_EQ(scanner.wait_until_done(patience).job->state, JobState::finished);
  EXPECT_EQ(stored(paused).intrinsics.fx, settings_.lens.fx);
}

TEST_F(ScanLens, IsSolvedEarlyWhereSomebodySaysThatItIsEnough) {
  Scanner scanner(rig_.options(board_speed), {}, store_);
  EXPECT_FALSE(scanner.solve_lens());
  after_views(scanner, 2, [&] { EXPECT_TRUE(scanner.solve_lens()); });
  ASSERT_TRUE(scanner.look_at_board(square));
  const CalibrationRun run = ended(scanner);
  EXPECT_EQ(run.state, CalibrationRun::State::refused);
  EXPECT_NE(run.lens->reason.find("at least 5"), std::string::npos) << run.lens->reason;
  EXPECT_EQ(error_thrown_by([&] { scanner.keep_lens({}); }).code(), ErrorCode::not_found);
}

TEST_F(ScanLens, IsNotLookedForAnyMoreAfterACancel) {
  Scanner scanner(rig_.options(board_speed), {}, store_);
  after_views(scanner, 1, [&] {
    EXPECT_FALSE(scanner.look_at_board(square)) << "one at a time";
    EXPECT_TRUE(scanner.cancel_calibration());
  });
  ASSERT_TRUE(scanner.look_at_board(square));
  EXPECT_EQ(ended(scanner).state, CalibrationRun::State::cancelled);
}

TEST_F(ScanLens, SaysWhatFailsWhereTheCameraIsPulled) {
  Scanner scanner(rig_.options(board_speed), {}, store_);
  after_views(scanner, 1, [&] { rig_.is_unplugged = true; });
  ASSERT_TRUE(scanner.look_at_board(square));
  const CalibrationRun run = ended(scanner);
  EXPECT_EQ(run.state, CalibrationRun::State::failed);
  EXPECT_EQ(run.failure->code, ErrorCode::sensor_lost);
}

TEST_F(ScanLens, OfADepthSensorIsKeptWithTheScaleOfItsDepths) {
  Scanner scanner({.sensor_uri = "octurn-simulator://?unit=1&speed=20", .speed = 20}, {}, store_);
  ASSERT_TRUE(scanner.look_at_board(square));
  const CalibrationRun run = ended(scanner);
  ASSERT_EQ(run.state, CalibrationRun::State::done) << (run.failure ? run.failure->detail : "");
  ScanSettings configured;
  configured.depth_scale = 1.02;  // a known length, before
  scanner.keep_lens(configured);
  EXPECT_EQ(scanner.calibration().in_force(configured).depth_scale, 1);
  const auto kept = optics_record(store_.data(), scanner.sensor_serial());
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->origin, OpticsOrigin::board);
  const SensorOptics truth = optics_of_unit(1);
  const SensorOptics& found = kept->optics.value;
  EXPECT_NEAR(found.fx, truth.fx, 0.002 * truth.fx);
  EXPECT_NEAR(found.cx, truth.cx, 1.5);
  EXPECT_NEAR(found.cy, truth.cy, 1.5);
  const auto corrected = [](const SensorOptics& optics) {
    return optics.depth_scale / (1 / 0.6 + optics.depth_offset_per_m);
  };
  EXPECT_NEAR(corrected(found) / corrected(truth), 1, 0.002);
}

}  // namespace
}  // namespace octurn
