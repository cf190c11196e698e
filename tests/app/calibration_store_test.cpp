#include "scan/calibration_store.hpp"

#include <gtest/gtest.h>

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
  fs::create_directory(folder.path() / "calibration.json");  // which no file can replace
  EXPECT_EQ(code_thrown_by([&] { store.set(record_at(2)); }), "write-failed");
  EXPECT_EQ(x_in_force(store), 1);
}

}  // namespace
}  // namespace octurn
