#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <numbers>
#include <string>

#include "core/io/scan_json.hpp"
#include "octurn/scan_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// Object from platform of the second pose: the object lies on its side, turned about Y by 90
/// degrees.
const json on_its_side = {{0, 0, 1, 0.25}, {0, 1, 0, 0.5}, {-1, 0, 0, 0.125}, {0, 0, 0, 1}};

/// A scan.json of two poses in the format of octurn/scan_folder.hpp, the second with its own rig.
json two_poses() {
  json scan = contract;
  scan["version"] = 2;
  scan["poses"] = {{{"object_from_platform", nullptr}},
                   {{"object_from_platform", on_its_side},
                    {"calibration", contract["calibration"]},
                    {"clip_m", {{"min", {-0.1, -0.1, 0.002}}, {"max", {0.1, 0.1, 0.3}}}}}};
  scan["poses"][1]["calibration"]["platform_from_sensor"][0][3] = 0.75;
  scan["snapshots"][1]["pose"] = 1;
  return scan;
}

std::string refusal_of(const json& scan) {
  const Error error = error_thrown_by([&] { parse_scan(scan.dump()); });
  EXPECT_EQ(error.code(), ErrorCode::scan_malformed);
  return error.what();
}

TEST(ScanOfPoses, HasTheSnapshotsOfEachInTheObjectsFrame) {
  const Scan scan = parse_scan(two_poses().dump());

  EXPECT_EQ(scan.shots[0].pose, 0);
  EXPECT_EQ(scan.shots[1].pose, 1);
  EXPECT_EQ(model_pose(scan, scan.shots[0]).matrix(), scan.platform_from_sensor.matrix());
  // The sensor stands at (0.75, -0.62, 0.4). Turning back by a quarter takes it to
  // (-0.62, -0.75, 0.4). The pose's X axis is the object's -Z, its Z axis the object's X.
  const Eigen::Vector3d eye = model_pose(scan, scan.shots[1]).translation();
  EXPECT_LT((eye - Eigen::Vector3d(0.4 + 0.25, -0.75 + 0.5, 0.62 + 0.125)).norm(), 1e-12);
}

TEST(ScanOfPoses, HasAThousandAtMost) {
  json scan = two_poses();
  while (scan["poses"].size() < 1000) {
    scan["poses"].push_back(scan["poses"][0]);
  }
  scan["snapshots"][0]["pose"] = 999;
  EXPECT_EQ(parse_scan(scan.dump()).shots[0].pose, 999);

  scan["poses"].push_back(scan["poses"][0]);
  EXPECT_NE(refusal_of(scan).find("at most 1000"), std::string::npos) << refusal_of(scan);
}

TEST(ScanOfPoses, HasAClipBoxForEachAndOneAroundAll) {
  const Scan scan = parse_scan(two_poses().dump());

  const std::vector<Placement> lying = placements(scan);
  const Box around = model_clip(scan);

  ASSERT_EQ(lying.size(), 2U);
  EXPECT_EQ(lying[0].clip.max, scan.clip.max);
  EXPECT_EQ(lying[1].clip.max, Eigen::Vector3d(0.1, 0.1, 0.3));
  EXPECT_LT((around.min - Eigen::Vector3d(-0.14, -0.15, 0.002)).norm(), 1e-12);  // first pose
  EXPECT_LT((around.max - Eigen::Vector3d(0.3 + 0.25, 0.1 + 0.5, 0.4)).norm(), 1e-12);
}

TEST(ScanOfPoses, SaysTheNumberOfAPoseThatIsNotKnown) {
  json scan = two_poses();
  scan["poses"][1]["object_from_platform"] = nullptr;

  const Scan read = parse_scan(scan.dump());

  EXPECT_NO_THROW(model_pose(read, read.shots[0]));
  const Error error = error_thrown_by([&] { model_pose(read, read.shots[1]); });
  EXPECT_NE(std::string(error.what()).find("pose 1 is not known"), std::string::npos);
  EXPECT_NE(error.hint().find("octurn merge"), std::string::npos);
  EXPECT_EQ(code_thrown_by([&] { placements(read); }), "scan-malformed");
}

TEST(ScanOfPoses, IsReadBackTheSame) {
  const TemporaryFolder folder;
  Scan written = parse_scan(two_poses().dump());
  written.poses[1].solved = SolvedPose{.position_sigma = 0.0005};

  write_scan(folder.path(), written);
  const Scan read = read_scan(folder.path());

  ASSERT_EQ(read.poses.size(), 2U);
  EXPECT_EQ(read.poses[1].object_from_platform->matrix(),
            written.poses[1].object_from_platform->matrix());
  EXPECT_EQ(read.poses[1].platform_from_sensor.matrix(),
            written.poses[1].platform_from_sensor.matrix());
  EXPECT_EQ(read.poses[1].clip.min, written.poses[1].clip.min);
  ASSERT_TRUE(read.poses[1].solved);
  EXPECT_FALSE(read.poses[0].solved);
  EXPECT_EQ(read.shots[1].pose, 1);
  EXPECT_EQ(json::parse(content_of(folder.path() / "scan.json"))["version"], 2);
}

TEST(ScanOfPoses, WithOneThatIsTheObjectsFrameIsAScanOfOneTurn) {
  json scan = two_poses();
  scan["poses"].erase(1);
  scan["poses"][0]["clip_m"] = {{"min", {-0.1, -0.1, 0}}, {"max", {0.1, 0.1, 0.3}}};
  scan["snapshots"][1].erase("pose");

  const Scan read = parse_scan(scan.dump());

  EXPECT_TRUE(is_one_turn(read));
  EXPECT_TRUE(placements(read).empty());
  EXPECT_EQ(model_clip(read).max, Eigen::Vector3d(0.1, 0.1, 0.3));
}

TEST(ScanOfPoses, RefusesAPoseThatIsNotListed) {
  json scan = two_poses();
  scan["snapshots"][0]["pose"] = 2;
  EXPECT_NE(refusal_of(scan).find("snapshots[0].pose"), std::string::npos);
  scan["snapshots"][0]["pose"] = -1;
  EXPECT_NE(refusal_of(scan).find("snapshots[0].pose"), std::string::npos);
  scan["snapshots"][0]["pose"] = 0;
  scan["poses"] = json::array();
  EXPECT_NE(refusal_of(scan).find("poses"), std::string::npos);
}

TEST(ScanOfPoses, RefusesAPoseThatIsNoRotation) {
  json scan = two_poses();
  scan["poses"][1]["object_from_platform"][0][0] = 2;
  EXPECT_NE(refusal_of(scan).find("poses[1].object_from_platform"), std::string::npos);
  scan["poses"][1].erase("object_from_platform");
  EXPECT_NE(refusal_of(scan).find("poses[1].object_from_platform"), std::string::npos);
}

TEST(ScanOfSensorPoses, NeedsNeitherCalibrationNorClipBox) {
  json scan = contract;
  scan["version"] = 2;
  for (json& snapshot : scan["snapshots"]) {
    snapshot.erase("angle_deg");
    snapshot["object_from_sensor"] = on_its_side;
  }
  scan.erase("calibration");
  scan.erase("clip_m");

  const Scan read = parse_scan(scan.dump());

  EXPECT_FALSE(is_one_turn(read));
  EXPECT_EQ(model_pose(read, read.shots[1]).translation(), Eigen::Vector3d(0.25, 0.5, 0.125));
  EXPECT_TRUE(has_free_poses(read));
  EXPECT_EQ(model_clip(read).max, everywhere.max);
  const TemporaryFolder folder;
  write_scan(folder.path(), read);
  const Scan again = read_scan(folder.path());
  EXPECT_EQ(again.shots[0].object_from_sensor->matrix(),
            read.shots[0].object_from_sensor->matrix());
}

TEST(ScanOfSensorPoses, ASnapshotHasOneOrAnAngle) {
  json scan = contract;
  scan["version"] = 2;
  scan["snapshots"][1]["object_from_sensor"] = on_its_side;
  EXPECT_NE(refusal_of(scan).find("either"), std::string::npos);
  scan["snapshots"][1].erase("angle_deg");
  EXPECT_NO_THROW(parse_scan(scan.dump()));  // one snapshot of each kind
  scan.erase("calibration");
  EXPECT_NE(refusal_of(scan).find("calibration"), std::string::npos);
  scan["snapshots"][1].erase("object_from_sensor");
  EXPECT_NE(refusal_of(scan).find("snapshots[1].angle_deg"), std::string::npos);
}

TEST(ScanOfSensorPoses, AreNoPartOfVersion1) {
  json scan = contract;
  scan["snapshots"][1]["object_from_sensor"] = "a key that version 1 passes over";
  scan["snapshots"][1]["pose"] = 7;
  scan["poses"] = 7;

  EXPECT_DOUBLE_EQ(parse_scan(scan.dump()).shots[1].angle, std::numbers::pi / 2);
}

}  // namespace
}  // namespace octurn
