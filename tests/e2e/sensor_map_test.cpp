// The map of the sensor's fixed error, made over HTTP from views of walls.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/daemon.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* calibration = "/api/v1/calibration";
constexpr const char* look = R"({"kind": "wall", "frames": 6})";

json get(const Daemon& daemon) { return parsed(daemon.get(calibration)); }

json wait_until_measured(const Daemon& daemon) {
  return daemon.wait_until(calibration,
                           [](const json& now) { return now["run"]["state"] != "running"; });
}

/// Records a view of a wall. @return the calibration after it
json look_at_wall(const Daemon& daemon) {
  const Reply begun = daemon.post(calibration, look);
  EXPECT_EQ(begun.status, 202) << begun.body;
  return wait_until_measured(daemon);
}

bool has_map_finding(const json& scan) {
  return std::ranges::any_of(scan["calibration"]["findings"],
                             [](const json& finding) { return finding["code"] == "no-map"; });
}

TEST(SensorMapApi, MakesAMapThatTheNextScanUses) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  EXPECT_EQ(get(daemon)["sensor_map"], nullptr);
  EXPECT_EQ(daemon.get("/api/v1/calibration/sensor-map").status, 404);
  const std::string twelve = R"({"snapshots": 12, "frames": 2, "leaf_size_mm": 4})";
  EXPECT_TRUE(has_map_finding(daemon.wait_until_done(daemon.start(twelve))));

  const json now = look_at_wall(daemon);
  const json& run = now["run"];
  ASSERT_EQ(run["state"], "done") << run;
  EXPECT_EQ(run["kind"], "wall");
  EXPECT_EQ(run["stop"], 6);
  EXPECT_EQ(run["stops"], 6);
  ASSERT_EQ(run["report"]["walls"].size(), 1U);
  EXPECT_NEAR(run["report"]["walls"][0]["distance_m"].get<double>(), 0.65, 0.005);
  EXPECT_EQ(now["sensor_map"]["serial"], "simulated-1");
  EXPECT_EQ(now["sensor_map"]["rms_before"], run["report"]["rms_before"]);
  EXPECT_LT(now["sensor_map"]["rms_after"], 0.6 * now["sensor_map"]["rms_before"].get<double>());
  EXPECT_GE(now["sensor_on_s"], 0);
  const json picture = parsed(daemon.get("/api/v1/calibration/sensor-map"));
  EXPECT_EQ(picture["errors"].size(), 80U * 60U);

  const json scan = daemon.wait_until_done(daemon.start(twelve));
  EXPECT_EQ(scan["state"], "finished") << scan;
  EXPECT_FALSE(has_map_finding(scan)) << scan["calibration"];
  EXPECT_TRUE(fs::exists(folder.path() / "data" / "scans" / scan["id"].get<std::string>() /
                         "sensor-map.png"));
}

TEST(SensorMapApi, AddsASecondWallAlsoAfterARestart) {
  const TemporaryFolder folder;
  json first;
  {
    const Daemon daemon(folder.path());
    first = look_at_wall(daemon)["sensor_map"];
  }
  const Daemon daemon(folder.path());
  const json now = look_at_wall(daemon);
  ASSERT_EQ(now["run"]["state"], "done") << now["run"];
  const json& walls = now["run"]["report"]["walls"];
  ASSERT_EQ(walls.size(), 2U);
  EXPECT_NEAR(walls[0]["distance_m"].get<double>(), 0.9, 0.01);
  EXPECT_NEAR(walls[1]["distance_m"].get<double>(), 0.65, 0.005);
  EXPECT_EQ(now["sensor_map"]["serial"], first["serial"]);

  const Reply removed = request(daemon.port(), "PATCH", calibration, R"({"sensor_map": null})");
  EXPECT_EQ(removed.status, 200) << removed.body;
  EXPECT_EQ(parsed(removed)["sensor_map"], nullptr);
  EXPECT_TRUE(fs::is_empty(folder.path() / "data" / "sensor-maps"));
  EXPECT_EQ(request(daemon.port(), "PATCH", calibration, R"({"sensor_map": null})").status, 404);
}

TEST(SensorMapApi, SaysWhyAWallIsRefused) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--sensor", "octurn-simulator://?speed=20&wall=2.5"});
  const json now = look_at_wall(daemon);
  EXPECT_EQ(now["run"]["state"], "refused");
  EXPECT_EQ(now["run"]["report"]["accepted"], false);
  EXPECT_NE(now["run"]["report"]["reason"].get<std::string>().find("2.5 m away"), std::string::npos)
      << now["run"]["report"];
  EXPECT_EQ(now["sensor_map"], nullptr);
}

TEST(SensorMapApi, IsCancelledAndLeavesThePlatformInView) {
  const TemporaryFolder folder;
  // 200 frames take 33 s.
  const Daemon daemon(folder.path(), {"--sensor", "octurn-simulator://?speed=0.2"});
  EXPECT_EQ(daemon.post(calibration, R"({"kind": "wall", "frames": 200})").status, 202);
  EXPECT_EQ(daemon.post(calibration, look).status, 409);
  EXPECT_EQ(request(daemon.port(), "PATCH", calibration, R"({"sensor_map": null})").status, 409);
  EXPECT_EQ(daemon.post(std::string(calibration) + "/cancel", "").status, 202);
  const json now = wait_until_measured(daemon);
  EXPECT_EQ(now["run"]["state"], "cancelled") << now["run"];
  EXPECT_EQ(now["sensor_map"], nullptr);
  const json scan = daemon.wait_until_done(daemon.start(quick));
  EXPECT_EQ(scan["state"], "finished") << scan;  // a view of the wall would give no model
}

TEST(SensorMapApi, RefusesABodyThatIsNone) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  for (const char* const body :
       {R"({"kind": "wall", "frames": 0})", R"({"kind": "wall", "frames": 201})",
        R"({"kind": "wall", "stops": 24})", R"({"kind": "wall", "frames": "25"})"}) {
    EXPECT_EQ(daemon.post(calibration, body).status, 400) << body;
  }
  for (const char* const body : {R"({"sensor_map": {}})", R"({"sensor_map": null, "a": 1})"}) {
    EXPECT_EQ(request(daemon.port(), "PATCH", calibration, body).status, 400) << body;
  }
}

}  // namespace
}  // namespace octurn
