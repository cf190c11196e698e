#include "calibration/calibration_store.hpp"

#include <gtest/gtest.h>

#include <stop_token>
#include <string>
#include <thread>

#include "calibration/optics_files.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

PoseRecord record_at(double x) {
  PoseRecord record{.origin = PoseOrigin::turn,
                    .at = "2026-11-21T08:15:00Z",
                    .figures = PoseFigures{.shift = 0.002,
                                           .tilt = 0.01,
                                           .position_sigma = 0.00004,
                                           .direction_sigma = 0.0002,
                                           .before = 0.0021,
                                           .after = 0.0005},
                    .scale = 1.01};
  record.platform_from_sensor.translation().x() = x;
  return record;
}

double x_in_force(const CalibrationStore& store) {
  return store.in_force({}).platform_from_sensor.translation().x();
}

TEST(CalibrationStore, LeavesTheSettingsPoseInForceUntilThereIsAnother) {
  const TemporaryFolder folder;
  const CalibrationStore store(folder.path());
  ScanSettings told;
  EXPECT_EQ(store.records(told).front().origin, PoseOrigin::drawing);
  told.platform_from_sensor.translation().x() = 0.003;
  EXPECT_EQ(store.records(told).front().origin, PoseOrigin::settings);
  EXPECT_EQ(store.records(told).size(), 1U);
  EXPECT_EQ(store.in_force(told).platform_from_sensor.matrix(), told.platform_from_sensor.matrix());
}

TEST(CalibrationStore, KeepsAPoseOverARestartToTheLastBit) {
  const TemporaryFolder folder;
  PoseRecord record = record_at(0.1);
  record.platform_from_sensor.linear() =
      Eigen::AngleAxisd(1.0 / 3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  CalibrationStore(folder.path()).set(record);

  const PoseRecord kept = CalibrationStore(folder.path()).records({}).front();
  EXPECT_EQ(kept.platform_from_sensor.matrix(), record.platform_from_sensor.matrix());
  EXPECT_EQ(kept.origin, PoseOrigin::turn);
  EXPECT_EQ(kept.at, record.at);
  EXPECT_EQ(kept.scale, 1.01);
  ASSERT_TRUE(kept.figures);
  EXPECT_NEAR(kept.figures->after, 0.0005, 1e-12);
  EXPECT_EQ(CalibrationStore(folder.path()).in_force({}).depth_scale, 1.01);
}

TEST(CalibrationStore, RemembersTenPosesBeforeTheOneInForce) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  for (int i = 0; i < 15; ++i) {
    store.set(record_at(0.1 * i));
  }
  const std::vector<PoseRecord> records = CalibrationStore(folder.path()).records({});
  ASSERT_EQ(records.size(), 11U);
  EXPECT_EQ(records.front().platform_from_sensor.translation().x(), 0.1 * 14);
  EXPECT_EQ(records.back().platform_from_sensor.translation().x(), 0.1 * 4);
}

TEST(CalibrationStore, TakesBackOnePoseAfterTheOtherToTheSettings) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  store.set(record_at(1));
  store.set(record_at(2));
  store.undo();
  EXPECT_EQ(x_in_force(store), 1);
  store.undo();
  EXPECT_EQ(x_in_force(store), nominal_platform_from_sensor().translation().x());
  EXPECT_EQ(code_thrown_by([&] { store.undo(); }), "not-found");
  EXPECT_EQ(CalibrationStore(folder.path()).records({}).size(), 1U);
}

TEST(CalibrationStore, KeepsThePlatformWhereItIsSeenWhenTheScaleChanges) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  store.change({.scale = 1.02}, {});
  ScanSettings now = store.in_force({});
  EXPECT_EQ(now.depth_scale, 1.02);
  EXPECT_TRUE(now.platform_from_sensor.translation().isApprox(
      1.02 * nominal_platform_from_sensor().translation(), 1e-12));
  store.change({.scale = 0.98}, {});
  now = store.in_force({});
  EXPECT_TRUE(now.platform_from_sensor.translation().isApprox(
      0.98 * nominal_platform_from_sensor().translation(), 1e-12));

  store.change({.is_settings_pose = true}, {});
  now = store.in_force({});
  EXPECT_EQ(now.depth_scale, 1);
  EXPECT_EQ(now.platform_from_sensor.matrix(), nominal_platform_from_sensor().matrix());
}

TEST(CalibrationStore, TakesAPoseThatAPersonGivesAsItIs) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  store.set(record_at(1));
  store.change({.platform_from_sensor = record_at(2).platform_from_sensor}, {});
  const PoseRecord now = store.records({}).front();
  EXPECT_EQ(x_in_force(store), 2);
  EXPECT_EQ(now.origin, PoseOrigin::page);
  EXPECT_EQ(now.scale, 1.01);
  EXPECT_FALSE(now.figures);
  EXPECT_FALSE(now.at.empty());
}

TEST(CalibrationStore, UsesTheLastGoodPoseWhereTheFileIsDamaged) {
  const TemporaryFolder folder;
  CalibrationStore(folder.path()).set(record_at(1));
  EXPECT_FALSE(find_damaged_calibration(folder.path()));
  const fs::path file = folder.path() / "calibration.json";
  const std::string whole = content_of(file);
  for (std::size_t length = 0; length < whole.size() - 1; length += 7) {
    put(file, whole.substr(0, length));
    EXPECT_EQ(x_in_force(CalibrationStore(folder.path())), 1) << length;
    const auto damage = find_damaged_calibration(folder.path());
    ASSERT_TRUE(damage) << length;
    EXPECT_NE(damage->find("calibration.json"), std::string::npos) << *damage;
  }
  put(folder.path() / "calibration.last.json", "{");
  EXPECT_EQ(CalibrationStore(folder.path()).records({}).front().origin, PoseOrigin::drawing);
}

TEST(CalibrationStore, LeavesThePoseAsItIsWhereItCannotBeWritten) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  store.set(record_at(1));
  fs::remove(folder.path() / "calibration.json");
  fs::create_directory(folder.path() / "calibration.json");  // no file can replace a folder
  EXPECT_EQ(code_thrown_by([&] { store.set(record_at(2)); }), "write-failed");
  EXPECT_EQ(x_in_force(store), 1);
}

PoseRecord record_of(const std::string& camera, double x) {
  PoseRecord record = record_at(x);
  record.scale = 1;
  record.camera = camera;
  record.lasers = {
      {.name = "left", .normal = Eigen::Vector3d(1, 2, 3).normalized(), .distance = x}};
  return record;
}

double x_in_force(const CalibrationStore& store, const char* camera) {
  return store.in_force({}, camera).platform_from_sensor.translation().x();
}

TEST(CalibrationStore, KeepsPosesAndPlanesOfEachCamera) {
  const TemporaryFolder folder;
  {
    CalibrationStore store(folder.path(), SensorKind::laser_line);
    store.set(record_of("one", 0.1));
    store.set(record_of("two", 0.2));
  }
  const CalibrationStore store(folder.path(), SensorKind::laser_line);
  EXPECT_EQ(x_in_force(store, "one"), 0.1);
  EXPECT_EQ(x_in_force(store, "two"), 0.2);
  EXPECT_EQ(store.records({}, "three").front().origin, PoseOrigin::settings);
  const PoseRecord one = store.records({}, "one").front();
  EXPECT_EQ(one.camera, "one");
  ASSERT_EQ(one.lasers.size(), 1U);
  EXPECT_EQ(one.lasers[0].name, "left");
  EXPECT_EQ(one.lasers[0].normal, Eigen::Vector3d(1, 2, 3).normalized());  // bit-exact
  EXPECT_EQ(one.lasers[0].distance, 0.1);
}

TEST(CalibrationStore, TakesBackThePoseOfOneCameraAlone) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path(), SensorKind::laser_line);
  store.set(record_of("one", 0.1));
  for (int i = 0; i < 20; ++i) {
    store.set(record_of("two", 0.2));  // more records than are kept for one camera
  }
  store.undo("one");
  EXPECT_EQ(store.records({}, "one").size(), 1U);
  EXPECT_EQ(store.records({}, "one").front().origin, PoseOrigin::settings);
  EXPECT_EQ(store.records({}, "two").size(), CalibrationStore::max_history + 1);
  EXPECT_EQ(code_thrown_by([&] { store.undo("one"); }), "not-found");
}

TEST(CalibrationStore, KeepsThePosesOfARigWithLasersFromThoseOfADepthSensor) {
  const TemporaryFolder folder;
  CalibrationStore(folder.path(), SensorKind::laser_line).set(record_of("one", 0.1));
  EXPECT_EQ(CalibrationStore(folder.path()).records({}).front().origin, PoseOrigin::drawing);
  ScanSettings told;
  told.platform_from_sensor = nominal_platform_from_camera();
  const CalibrationStore store(folder.path(), SensorKind::laser_line);
  EXPECT_EQ(store.records(told, "two").front().origin, PoseOrigin::drawing);
}

TEST(CalibrationStore, NamesADamagedFileOfARigWithLasers) {
  const TemporaryFolder folder;
  CalibrationStore(folder.path(), SensorKind::laser_line).set(record_of("one", 0.1));
  EXPECT_FALSE(find_damaged_calibration(folder.path()));
  put(folder.path() / "laser-calibration.json", "{");
  EXPECT_EQ(x_in_force(CalibrationStore(folder.path(), SensorKind::laser_line), "one"), 0.1);
  const auto damage = find_damaged_calibration(folder.path());
  ASSERT_TRUE(damage);
  EXPECT_NE(damage->find("laser-calibration.json"), std::string::npos) << *damage;
}

/// A pose that was solved with optics of the sensor A at that time.
PoseRecord record_with_optics(double x, const std::string& at) {
  PoseRecord record = record_at(x);
  record.optics_of = "A";
  record.optics_at = at;
  return record;
}

TEST(CalibrationStore, KeepsTheOpticsWithWhichAPoseHolds) {
  const TemporaryFolder folder;
  CalibrationStore(folder.path()).set(record_with_optics(0.1, "2026-11-28T08:00:00Z"));
  const PoseRecord kept = CalibrationStore(folder.path()).records({}).front();
  EXPECT_EQ(kept.optics_of, "A");
  EXPECT_EQ(kept.optics_at, "2026-11-28T08:00:00Z");
}

// A pose is written before its optics: as after a power cut in between.
TEST(CalibrationStore, DropsAPoseWhoseOpticsWereNotWritten) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  store.set(record_at(0.1));
  store.set(record_with_optics(0.2, "2026-11-28T08:00:00Z"));
  store.set(record_with_optics(0.3, "2026-11-28T08:00:00Z"));  // confirmed by a later scan
  store.drop_without_optics("B");
  EXPECT_EQ(x_in_force(store), 0.3) << "another sensor";
  store.drop_without_optics("");
  EXPECT_EQ(x_in_force(store), 0.3) << "nobody knows which sensor";
  store.drop_without_optics("A");
  EXPECT_EQ(x_in_force(store), 0.1);
  EXPECT_EQ(x_in_force(CalibrationStore(folder.path())), 0.1);
}

TEST(CalibrationStore, KeepsAPoseWithOpticsInForceOrBeforeThose) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  store.set(record_with_optics(0.2, "2026-11-28T08:00:00Z"));
  for (const char* at : {"2026-11-28T08:00:00Z", "2026-11-28T09:00:00Z"}) {
    keep_optics(folder.path(), "A", {.at = at});
    store.drop_without_optics("A");
    EXPECT_EQ(x_in_force(store), 0.2);
  }
}

TEST(CalibrationStore, TakesAPoseOfAPersonForOneThatHoldsWithAnyOptics) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  store.set(record_with_optics(0.2, "2026-11-28T08:00:00Z"));
  store.change({.scale = 1.02}, {});
  EXPECT_EQ(store.records({}).front().optics_of, "A") << "the same pose, scaled";
  Eigen::Isometry3d entered = Eigen::Isometry3d::Identity();
  entered.translation().x() = 0.5;
  store.change({.platform_from_sensor = entered}, {});
  store.drop_without_optics("A");
  EXPECT_EQ(x_in_force(store), 0.5);
}

// The board's optics of a sensor whose depths a known length had corrected: one more reported depth
// of the platform's middle, the same pixel.
TEST(CalibrationStore, MovesThePlatformAsTheDepthsOfNewOptics) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  PoseRecord record = record_at(0);
  record.platform_from_sensor = nominal_platform_from_sensor();
  record.scale = 1.03;
  store.set(record);
  const SensorOptics before{.depth_scale = 0.99, .depth_offset_per_m = 0.002};
  const OpticsRecord now{.optics = {.value = {.depth_scale = 1.012, .depth_offset_per_m = -0.008}},
                         .at = "2026-11-28T08:00:00Z"};
  keep_optics(folder.path(), "A", {.optics = {.value = before}, .at = "2026-11-27T08:00:00Z"});
  store.use_optics("A", now, {});

  const PoseRecord moved = store.records({}).front();
  const Eigen::Vector3d old_middle = record.platform_from_sensor.inverse().translation();
  const Eigen::Vector3d middle = moved.platform_from_sensor.inverse().translation();
  const double reported = 1.03 * 0.99 / old_middle.z() - 0.002;  // 1/m
  EXPECT_NEAR(middle.z(), 1.012 / (reported - 0.008), 1e-12);
  EXPECT_TRUE((middle / middle.z()).isApprox(old_middle / old_middle.z(), 1e-12));
  EXPECT_EQ(moved.scale, 1);
  EXPECT_EQ(moved.origin, PoseOrigin::page);
  EXPECT_EQ(moved.at, now.at);
  EXPECT_FALSE(moved.figures);
  store.drop_without_optics("A");
  EXPECT_EQ(store.records({}).front().at, now.at);
  undo_optics(folder.path(), "A");
  store.drop_without_optics("A");
  EXPECT_EQ(store.records({}).front().scale, 1.03) << "the pose before";
}

TEST(CalibrationStore, PutsABoardsScaleInPlaceOfTheSettingsLength) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  const OpticsRecord now{.optics = {.value = {.depth_scale = 1.012}}, .at = "2026-11-28T08:00:00Z"};
  store.use_optics("B", now, {});
  EXPECT_TRUE(store.records({}).front().at.empty()) << "the drawing has no scale to replace";

  ScanSettings configured;
  configured.depth_scale = 1.02;
  store.use_optics("A", now, configured);
  EXPECT_EQ(store.in_force(configured).depth_scale, 1);
  EXPECT_EQ(store.in_force(configured).platform_from_sensor.matrix(),
            nominal_platform_from_sensor().matrix());
}

// A sensor that opens drops poses without optics, on another thread than the one that writes them.
TEST(CalibrationStore, DropsNoPoseWhoseOpticsAreBeingWritten) {
  const TemporaryFolder folder;
  CalibrationStore store(folder.path());
  const std::jthread opening([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      store.drop_without_optics("A");
    }
  });
  ScanSettings configured;
  configured.depth_scale = 1.02;
  for (int i = 0; i < 20; ++i) {
    const std::string at = "turn " + std::to_string(i);
    store.set(record_with_optics(0.1, at), {.at = at});
    ASSERT_EQ(store.records({}).front().optics_at, at);
    const std::string board = "board " + std::to_string(i);
    store.use_optics("A", {.at = board}, configured);
    ASSERT_EQ(store.records({}).front().optics_at, board);
  }
}

}  // namespace
}  // namespace octurn
