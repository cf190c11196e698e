#include "octurn/scan_folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "core/io/scan_json.hpp"
#include "octurn/png.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

TEST(ReadScan, SaysWhichFileIsMissing) {
  const TemporaryFolder folder;

  const Error error = error_thrown_by([&] { read_scan(folder.path()); });

  EXPECT_EQ(error.code(), ErrorCode::scan_missing);
  EXPECT_NE(std::string(error.what()).find("scan.json"), std::string::npos);
}

TEST(ReadScan, RefusesAFolderInPlaceOfItsFile) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "scan.json");

  EXPECT_EQ(code_thrown_by([&] { read_scan(folder.path()); }), "scan-missing");
}

TEST(ReadScan, RefusesAFileTooLargeToBeOne) {
  const TemporaryFolder folder;
  put(folder.path() / "scan.json", contract.dump());
  std::filesystem::resize_file(folder.path() / "scan.json", 1ULL << 40U);  // a sparse file

  EXPECT_EQ(code_thrown_by([&] { read_scan(folder.path()); }), "scan-malformed");
}

TEST(ReadSnapshot, IsTheImageSeenFromItsAngle) {
  const TemporaryFolder folder;
  const Scan scan = write_contract_scan(folder.path());
  const Shot quarter_turn{.file = "snapshots/000.png", .angle = std::numbers::pi / 2};

  const Snapshot snapshot = read_snapshot(folder.path(), scan, quarter_turn);

  EXPECT_EQ(snapshot.frame.depth[1], 8001);
  EXPECT_EQ(snapshot.intrinsics.fx, 575.8);
  // The sensor stands at (0.01, -0.62, 0.4). In the frame of the object, which turned 90 degrees
  // counter-clockwise, it moved clockwise to (-0.62, -0.01, 0.4).
  const Eigen::Vector3d eye = snapshot.object_from_sensor.translation();
  EXPECT_LT((eye - Eigen::Vector3d(-0.62, -0.01, 0.4)).norm(), 1e-12);
}

/// A sensor map for the size of `contract`, with the same error (1/m) at every pixel.
SensorMap map_of(float error, int width = 4) {
  return {.width = width,
          .height = 3,
          .near_inverse_depth = 1.5,
          .near = std::vector<float>(static_cast<std::size_t>(width) * 3, error)};
}

TEST(ReadSnapshot, IsCorrectedByTheFoldersSensorMap) {
  const TemporaryFolder folder;
  write_contract_scan(folder.path());
  const std::string stored = content_of(folder.path() / "snapshots" / "000.png");
  write_sensor_map(folder.path() / sensor_map_file, map_of(0.01F));
  const Scan scan = read_scan(folder.path());

  const Snapshot snapshot = read_snapshot(folder.path(), scan, scan.shots[0]);

  EXPECT_EQ(snapshot.frame.depth[0], 0);
  EXPECT_EQ(snapshot.frame.depth[1], std::lround(1e4 / (1e4 / 8001 - 0.01)));
  EXPECT_EQ(content_of(folder.path() / "snapshots" / "000.png"), stored);
}

TEST(UseSensorMap, ReplacesTheFoldersOwn) {
  const TemporaryFolder folder;
  write_contract_scan(folder.path());
  write_sensor_map(folder.path() / sensor_map_file, map_of(0.01F));
  write_sensor_map(folder.path() / "other.png", map_of(-0.02F));
  Scan scan = read_scan(folder.path());

  use_sensor_map(scan, folder.path() / "other.png");

  EXPECT_EQ(read_snapshot(folder.path(), scan, scan.shots[0]).frame.depth[1],
            std::lround(1e4 / (1e4 / 8001 + 0.02)));
}

TEST(UseSensorMap, RefusesAMapOfAnotherSize) {
  const TemporaryFolder folder;
  Scan scan = write_contract_scan(folder.path());
  write_sensor_map(folder.path() / sensor_map_file, map_of(0.01F, 5));

  EXPECT_EQ(code_thrown_by([&] { use_sensor_map(scan, folder.path() / sensor_map_file); }),
            "scan-malformed");
  EXPECT_EQ(code_thrown_by([&] { read_scan(folder.path()); }), "scan-malformed");
}

TEST(ReadScan, RefusesASensorMapThatIsDamaged) {
  const TemporaryFolder folder;
  write_contract_scan(folder.path());
  put(folder.path() / sensor_map_file, "no map");

  EXPECT_EQ(code_thrown_by([&] { read_scan(folder.path()); }), "scan-malformed");
}

TEST(WriteScan, KeepsTheSensorsSerialNumber) {
  const TemporaryFolder folder;
  Scan scan = write_contract_scan(folder.path());
  EXPECT_EQ(scan.sensor_serial, "");
  scan.sensor_serial = "A00361";

  write_scan(folder.path(), scan);

  EXPECT_EQ(read_scan(folder.path()).sensor_serial, "A00361");
}

TEST(WriteScan, KeepsTheShareOfLostPackets) {
  const TemporaryFolder folder;
  Scan scan = write_contract_scan(folder.path());
  scan.shots[1].lost_share = 0.02;
  scan.shots[1].slipped = radians_from_degrees(-1.8);

  write_scan(folder.path(), scan);

  const Scan read = read_scan(folder.path());
  EXPECT_EQ(read.shots[0].lost_share, 0);
  EXPECT_DOUBLE_EQ(read.shots[1].lost_share, 0.02);
  EXPECT_EQ(read.shots[0].slipped, 0);
  EXPECT_DOUBLE_EQ(read.shots[1].slipped, radians_from_degrees(-1.8));
  EXPECT_TRUE(model_pose(read, read.shots[1])
                  .isApprox(object_from_sensor(read.platform_from_sensor,
                                               read.shots[1].angle + read.shots[1].slipped)));
}

TEST(ReadSnapshot, SaysWhichFileIsMissing) {
  const TemporaryFolder folder;
  const Scan scan = write_contract_scan(folder.path());

  const Error error = error_thrown_by([&] { read_snapshot(folder.path(), scan, scan.shots[1]); });

  EXPECT_EQ(error.code(), ErrorCode::scan_missing);
  EXPECT_NE(std::string(error.what()).find("snapshots/001.png"), std::string::npos);
}

TEST(ReadSnapshot, SaysWhichFileIsDamaged) {
  const TemporaryFolder folder;
  const Scan scan = write_contract_scan(folder.path());
  put(folder.path() / "snapshots/001.png", "no image");

  const Error error = error_thrown_by([&] { read_snapshot(folder.path(), scan, scan.shots[1]); });

  EXPECT_EQ(error.code(), ErrorCode::snapshot_malformed);
  EXPECT_NE(std::string(error.what()).find("snapshots/001.png"), std::string::npos);
}

TEST(WriteScan, IsReadBackTheSame) {
  const TemporaryFolder folder;
  const Scan written = parse_scan(contract.dump());

  write_scan(folder.path(), written);
  const Scan read = read_scan(folder.path());

  EXPECT_EQ(read.sensor_name, written.sensor_name);
  EXPECT_EQ(read.intrinsics.cy, written.intrinsics.cy);
  EXPECT_EQ(read.platform_from_sensor.matrix(), written.platform_from_sensor.matrix());
  EXPECT_EQ(read.clip.min, written.clip.min);
  EXPECT_EQ(read.clip.max, written.clip.max);
  ASSERT_EQ(read.shots.size(), 2U);
  EXPECT_EQ(read.shots[0].file, "snapshots/000.png");
  EXPECT_DOUBLE_EQ(read.shots[1].angle, written.shots[1].angle);
}

TEST(WriteScan, WritesTheKeysOfTheContractAndNothingElse) {
  const TemporaryFolder folder;

  write_scan(folder.path(), parse_scan(contract.dump()));

  const json written = json::parse(content_of(folder.path() / "scan.json"));
  EXPECT_EQ(written, contract);
}

TEST(WriteSolvedPose, StandsBesideTheToldOneAndIsThatOfModels) {
  const TemporaryFolder folder;
  write_contract_scan(folder.path());
  json before = contract;
  before["filter"] = "average";  // a key that readers ignore
  put(folder.path() / "scan.json", before.dump());
  SolvedPose solved{.position_sigma = 0.00025, .direction_sigma = 0.001, .before = 0.002};
  solved.after = 0.0005;
  solved.platform_from_sensor.translation() = Eigen::Vector3d(0.25, -0.5, 0.125);
  solved.optics = {.value = {.fx = 590, .k1 = -0.1}, .sigma = {.fx = 2}};

  write_solved_pose(folder.path(), solved);

  const json written = json::parse(content_of(folder.path() / "scan.json"));
  EXPECT_EQ(written["calibration"]["platform_from_sensor"],
            contract["calibration"]["platform_from_sensor"]);
  EXPECT_EQ(written["calibration"]["solved"]["sigma_mm"], 0.25);
  EXPECT_EQ(written["filter"], "average");
  const Scan read = read_scan(folder.path());
  ASSERT_TRUE(read.solved);
  EXPECT_EQ(read.solved->platform_from_sensor.matrix(), solved.platform_from_sensor.matrix());
  EXPECT_DOUBLE_EQ(read.solved->direction_sigma, 0.001);
  EXPECT_DOUBLE_EQ(read.solved->after, 0.0005);
  EXPECT_EQ(read_snapshot(folder.path(), read, read.shots[0]).object_from_sensor.translation(),
            Eigen::Vector3d(0.25, -0.5, 0.125));
  write_scan(folder.path(), read);
  const Scan again = read_scan(folder.path());
  ASSERT_TRUE(again.solved && again.solved->optics);
  EXPECT_EQ(again.solved->optics->value.k1, -0.1);
  EXPECT_EQ(again.solved->optics->sigma.fx, 2);
}

TEST(WriteSolvedPose, ReplacesTheSlipsOfAnEarlierOne) {
  const TemporaryFolder folder;
  write_contract_scan(folder.path());
  const auto slipped_at = [&](std::size_t shot) {
    return read_scan(folder.path()).shots.at(shot).slipped;
  };
  write_solved_pose(folder.path(), {}, std::array{0.0, 0.03});
  EXPECT_EQ(slipped_at(0), 0);
  EXPECT_NEAR(slipped_at(1), 0.03, 1e-9);
  write_solved_pose(folder.path(), {}, std::array{0.02, 0.0});
  EXPECT_NEAR(slipped_at(0), 0.02, 1e-9);
  EXPECT_EQ(slipped_at(1), 0);
  write_solved_pose(folder.path(), {});
  EXPECT_EQ(slipped_at(0), 0);
}

TEST(WriteScan, ReplacesWhatIsNoUtf8InASensorsName) {
  const TemporaryFolder folder;
  Scan scan = parse_scan(contract.dump());
  scan.sensor_name = "Kinect\xff";

  write_scan(folder.path(), scan);

  EXPECT_EQ(read_scan(folder.path()).sensor_name, "Kinect\xef\xbf\xbd");
}

TEST(WriteDepthPng, MakesItsFolderAndIsReadBackTheSame) {
  const TemporaryFolder folder;
  const Scan scan = parse_scan(contract.dump());
  const DepthFrame frame{
      .width = 4, .height = 3, .depth = {0, 1, 2, 3, 255, 256, 257, 258, 65535, 8000, 8001, 0}};

  write_depth_png(folder.path() / shot_file(0), frame);

  EXPECT_EQ(read_snapshot(folder.path(), scan, scan.shots[0]).frame.depth, frame.depth);
}

TEST(ShotFile, NumbersWithThreeDigitsOrMore) {
  EXPECT_EQ(shot_file(0), "snapshots/000.png");
  EXPECT_EQ(shot_file(42), "snapshots/042.png");
  EXPECT_EQ(shot_file(999), "snapshots/999.png");
  EXPECT_EQ(shot_file(1000), "snapshots/1000.png");
}

}  // namespace
}  // namespace octurn
