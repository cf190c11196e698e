#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/io/scan_json.hpp"
#include "octurn/scan_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// A scan.json of a scan by line lasers, in the format of octurn/scan_folder.hpp.
const json laser_contract = json::parse(R"({
  "format": "octurn-scan", "version": 2,
  "sensor": {"kind": "laser-line", "name": "Camera", "width": 1640, "height": 1232, "fx": 1358.9,
             "fy": 1358.9, "cx": 819.5, "cy": 615.5, "k1": -0.05, "k2": 0.01,
             "lasers": [{"name": "left", "plane_m": [0.8, 0, -0.6, -0.14],
                         "source_m": [-0.2, 0.05, -0.033]},
                        {"name": "right", "plane_m": [0.8, 0, 0.6, 0.14]}]},
  "calibration": {"platform_from_sensor": [[1, 0, 0, 0.01], [0, -0.6, 0.8, -0.62],
                                           [0, -0.8, -0.6, 0.4], [0, 0, 0, 1]]},
  "clip_m": {"min": [-0.09, -0.09, 0.002], "max": [0.09, 0.09, 0.2]},
  "snapshots": [{"files": {"dark": "snapshots/0-dark.png", "left": "snapshots/0-left.png",
                           "right": "snapshots/0-right.png"}, "angle_deg": 0.0},
                {"files": {"dark": "snapshots/1-dark.png", "left": "snapshots/1-left.png",
                           "right": "snapshots/1-right.png"}, "angle_deg": 90.0}]})");

json with(const char* pointer, const json& value) {
  json changed = laser_contract;
  changed[json::json_pointer(pointer)] = value;
  return changed;
}

void expect_refused(const json& scan, const std::string& named) {
  const Error error = error_thrown_by([&] { parse_scan(scan.dump()); });
  EXPECT_EQ(error.code(), ErrorCode::scan_malformed) << scan.dump();
  EXPECT_NE(std::string(error.what()).find(named), std::string::npos)
      << error.what() << "\ndoes not name " << named;
}

TEST(LaserJson, TakesWhatTheContractNames) {
  const Scan scan = parse_scan(laser_contract.dump());

  ASSERT_TRUE(scan.laser);
  EXPECT_EQ(scan.laser->k1, -0.05);
  EXPECT_EQ(scan.laser->k2, 0.01);
  ASSERT_EQ(scan.laser->lasers.size(), 2U);
  const Laser& left = scan.laser->lasers[0];
  EXPECT_EQ(left.name, "left");
  EXPECT_LT((left.normal - Eigen::Vector3d(0.8, 0, -0.6)).norm(), 1e-12);
  EXPECT_DOUBLE_EQ(left.distance, -0.14);
  ASSERT_TRUE(left.source);
  EXPECT_EQ(*left.source, Eigen::Vector3d(-0.2, 0.05, -0.033));
  EXPECT_FALSE(scan.laser->lasers[1].source);
  EXPECT_EQ(scan.shots[1].pictures,
            (std::vector<std::string>{"snapshots/1-dark.png", "snapshots/1-left.png",
                                      "snapshots/1-right.png"}));
}

TEST(LaserJson, MakesModelsWithThePlanesThatWereSolved) {
  json solved = laser_contract;
  solved["calibration"]["solved"] = {
      {"platform_from_sensor", laser_contract["calibration"]["platform_from_sensor"]},
      {"sigma_mm", 0.02},
      {"sigma_deg", 0.01},
      {"before_mm", 0.4},
      {"after_mm", 0.1},
      {"lasers", {{{"name", "right"}, {"plane_m", {0.6, 0, 0.8, 0.15}}}}}};
  const Scan scan = parse_scan(solved.dump());

  const std::vector<Laser> lasers = model_lasers(*scan.laser, scan.solved);

  EXPECT_DOUBLE_EQ(lasers[0].distance, -0.14);  // as told: nothing solved
  EXPECT_TRUE(lasers[0].source);
  EXPECT_DOUBLE_EQ(lasers[1].distance, 0.15);
  EXPECT_LT((lasers[1].normal - Eigen::Vector3d(0.6, 0, 0.8)).norm(), 1e-12);

  solved["calibration"]["solved"]["lasers"][0]["name"] = "third";
  expect_refused(solved, "\"third\"");
}

TEST(LaserJson, ComesBackAsItWasWritten) {
  TemporaryFolder folder;
  const Scan scan = parse_scan(laser_contract.dump());
  write_scan(folder.path(), scan);
  const json written = json::parse(content_of(folder.path() / "scan.json"));
  const Scan again = read_scan(folder.path());

  EXPECT_EQ(written["version"], 2);
  EXPECT_EQ(written["sensor"]["kind"], "laser-line");
  EXPECT_FALSE(written["sensor"].contains("depth_unit_m"));
  EXPECT_EQ(again.shots[1].pictures, scan.shots[1].pictures);
  EXPECT_EQ(again.laser->lasers[0].source, scan.laser->lasers[0].source);
  EXPECT_EQ(again.laser->k1, scan.laser->k1);
}

TEST(LaserJson, RefusesEachMissingKeyByName) {
  for (const char* key : {"width", "height", "fx", "fy", "cx", "cy", "k1", "k2", "lasers"}) {
    json changed = laser_contract;
    changed["sensor"].erase(key);
    expect_refused(changed, std::string("\"sensor.") + key + "\" is missing");
  }
  for (const char* key : {"name", "plane_m"}) {
    json changed = laser_contract;
    changed["sensor"]["lasers"][1].erase(key);
    expect_refused(changed, std::string("\"sensor.lasers[1].") + key + "\" is missing");
  }
  for (const char* key : {"dark", "left", "right"}) {
    json changed = laser_contract;
    changed["snapshots"][1]["files"].erase(key);
    expect_refused(changed, std::string("\"snapshots[1].files.") + key + "\" is missing");
  }
  json changed = laser_contract;
  changed["snapshots"][0].erase("files");
  expect_refused(changed, "\"snapshots[0].files\" is missing");
}

TEST(LaserJson, RefusesWhatIsWrongByName) {
  expect_refused(with("/version", 1), "\"version\"");
  expect_refused(with("/sensor/kind", "radar"), "\"sensor.kind\"");
  expect_refused(with("/sensor/k1", "-0.05"), "\"sensor.k1\"");
  expect_refused(with("/sensor/k1", -5), "\"sensor.k1\"");  // is not invertible up to the corners
  expect_refused(with("/sensor/lasers", json::array()), "\"sensor.lasers\"");
  expect_refused(with("/sensor/lasers/0/plane_m", {1, 1, 0, 0.1}), "\"sensor.lasers[0].plane_m\"");
  expect_refused(with("/sensor/lasers/0/plane_m", {1, 0, 0}), "\"sensor.lasers[0].plane_m\"");
  expect_refused(with("/sensor/lasers/0/plane_m/3", "x"), "\"sensor.lasers[0].plane_m[3]\"");
  expect_refused(with("/sensor/lasers/0/source_m", {0.3, 0, 0}), "\"sensor.lasers[0].source_m\"");
  expect_refused(with("/sensor/lasers/0/name", "dark"), "\"sensor.lasers[0].name\"");
  expect_refused(with("/sensor/lasers/1/name", "left"), "\"sensor.lasers[1]\"");
  expect_refused(with("/snapshots/1/files/left", "../left.png"), "\"snapshots[1].files.left\"");
  expect_refused(with("/snapshots/1/files", "0.png"), "\"snapshots[1].files\"");
}

TEST(LaserJson, HasNoDepthImages) {
  const Scan scan = parse_scan(laser_contract.dump());
  const Error error = error_thrown_by([&] { read_snapshot("/nowhere", scan, scan.shots[0]); });
  EXPECT_EQ(error.code(), ErrorCode::scan_malformed);
}

}  // namespace
}  // namespace octurn
