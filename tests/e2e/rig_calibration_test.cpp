// The pose of the rig: stored and measured by the daemon, and `octurn calibrate` without a scan.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "octurn/units.hpp"
#include "rig/nominal_pose.hpp"
#include "support/daemon.hpp"
#include "support/wrong_pose.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* calibration_path = "/api/v1/calibration";

/// The distance between a pose's sensor position and the true one, millimetres.
double off_mm(const json& rows) {
  const auto at = [&](std::size_t row) { return rows[row][3].get<double>(); };
  const Eigen::Vector3d truth = misaligned_platform_from_sensor(1).translation();
  return mm_from_metres((Eigen::Vector3d(at(0), at(1), at(2)) - truth).norm());
}

/// Arguments of a daemon whose octurn.json has a wrong pose.
std::vector<std::string> wrongly_told(const TemporaryFolder& folder) {
  const fs::path file = folder.path() / "octurn.json";
  const json scan{{"platform_from_sensor", to_rows(wrong_pose())},
                  {"snapshots", 8},
                  {"frames", 2},
                  {"leaf_size_mm", 4}};
  put(file, json{{"scan", scan}}.dump());
  return {"--config", file};
}

json get(const Daemon& daemon) { return parsed(daemon.get(calibration_path)); }

Reply patch(const Daemon& daemon, const json& body) {
  return request(daemon.port(), "PATCH", calibration_path, body.dump());
}

json wait_until_measured(const Daemon& daemon) {
  return daemon.wait_until(calibration_path,
                           [](const json& now) { return now["run"]["state"] != "running"; });
}

TEST(RigCalibration, IsThatOfTheDrawingAtFirst) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json now = get(daemon);
  EXPECT_EQ(now["source"], "default");
  EXPECT_EQ(now["platform_from_sensor"], to_rows(nominal_platform_from_sensor()));
  EXPECT_EQ(now["at"], nullptr);
  EXPECT_EQ(now["sigma_mm"], nullptr);
  EXPECT_EQ(now["scale"], 1.0);
  EXPECT_EQ(now["history"], json::array());
  EXPECT_EQ(now["run"], nullptr);
}

TEST(RigCalibration, IsSetByHandAndTakenBackAndKept) {
  const TemporaryFolder folder;
  {
    Daemon daemon(folder.path(), wrongly_told(folder));
    EXPECT_EQ(get(daemon)["source"], "settings");
    const Reply set =
        patch(daemon, {{"platform_from_sensor", to_rows(nominal_platform_from_sensor())}});
    EXPECT_EQ(set.status, 200) << set.body;
    EXPECT_EQ(parsed(set)["source"], "page");
    EXPECT_EQ(patch(daemon, {{"scale", 1.01}}).status, 200);
    EXPECT_EQ(parsed(daemon.get("/api/v1/settings"))["defaults"]["depth_scale"], 1.01);
    for (const json& bad : {json{{"scale", 1.2}}, json{{"scale", "1"}}, json::object(),
                            json{{"platform_from_sensor", {{1}}}}, json{{"pose", 1}}}) {
      const Reply refused = patch(daemon, bad);
      EXPECT_EQ(refused.status, 400) << bad;
      EXPECT_EQ(parsed(refused)["code"], "bad-settings") << bad;
    }
    daemon.program().send_signal(SIGKILL);
    daemon.program().wait();
  }
  const Daemon daemon(folder.path(), wrongly_told(folder));
  EXPECT_EQ(get(daemon)["scale"], 1.01);
  ASSERT_EQ(get(daemon)["history"].size(), 1U);
  EXPECT_EQ(get(daemon)["history"][0]["source"], "page");
  EXPECT_EQ(daemon.post(std::string(calibration_path) + "/undo", "").status, 200);
  EXPECT_EQ(get(daemon)["scale"], 1.0);
  EXPECT_EQ(get(daemon)["platform_from_sensor"], to_rows(nominal_platform_from_sensor()));
  EXPECT_EQ(patch(daemon, {{"platform_from_sensor", nullptr}}).status, 200);
  EXPECT_EQ(get(daemon)["source"], "settings");
  EXPECT_EQ(get(daemon)["platform_from_sensor"], to_rows(wrong_pose()));
}

TEST(RigCalibration, IsMeasuredWithATurnThatTheNextScanUses) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), wrongly_told(folder));
  const Reply begun = daemon.post(calibration_path, R"({"kind": "turn", "stops": 12})");
  EXPECT_EQ(begun.status, 202) << begun.body;
  EXPECT_EQ(parsed(begun)["run"]["state"], "running");
  EXPECT_EQ(parsed(begun)["run"]["stops"], 12);
  const json now = wait_until_measured(daemon);
  const json& run = now["run"];
  ASSERT_EQ(run["state"], "done") << run["report"]["reason"] << run["error"];
  EXPECT_EQ(run["report"]["accepted"], true);
  EXPECT_TRUE(run["report"]["stops"].is_array());
  EXPECT_GT(run["report"]["slice_mm"]["before"].size(), 100U);
  EXPECT_GT(run["report"]["slice_mm"]["after"].size(), 100U);
  EXPECT_EQ(now["source"], "turn");
  EXPECT_LT(now["after_mm"], now["before_mm"]);
  EXPECT_GT(off_mm(to_rows(wrong_pose())), 20);
  // A fifth of the initial error; the sensor's pattern alone makes 2 mm.
  EXPECT_LT(off_mm(now["platform_from_sensor"]), 4);

  const json scan = daemon.wait_until_done(daemon.start("{}"));
  EXPECT_EQ(scan["settings"]["platform_from_sensor"], now["platform_from_sensor"]);
  EXPECT_EQ(scan["state"], "finished") << scan;
}

TEST(RigCalibration, IsThatOfTheLastScanThatSolvedItsOwn) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), wrongly_told(folder));
  const json scan = daemon.wait_until_done(daemon.start("{}"));
  ASSERT_EQ(scan["calibration"]["accepted"], true) << scan;
  EXPECT_EQ(get(daemon)["source"], "scan");
  EXPECT_EQ(get(daemon)["platform_from_sensor"],
            scan["calibration"]["solved"]["platform_from_sensor"]);
  EXPECT_TRUE(scan["model"]["quality"].contains("verdict")) << scan["model"];
}

TEST(RigCalibration, StaysAsItIsWhenTheTurnIsCancelled) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--simulate-speed", "1"});  // the turn takes 40 s
  const std::string cancel = std::string(calibration_path) + "/cancel";
  EXPECT_EQ(parsed(daemon.post(cancel, ""))["code"], "not-running");
  EXPECT_EQ(daemon.post(calibration_path, R"({"kind": "turn", "stops": 72})").status, 202);
  for (const char* const path : {calibration_path, "/api/v1/scans"}) {
    const Reply second =
        daemon.post(path, path == calibration_path ? R"({"kind": "turn"})" : R"({"snapshots": 3})");
    EXPECT_EQ(second.status, 409) << path;
    EXPECT_EQ(parsed(second)["code"], "busy");
  }
  EXPECT_EQ(daemon.post(cancel, "").status, 202);
  EXPECT_EQ(wait_until_measured(daemon)["run"]["state"], "cancelled");
  EXPECT_EQ(get(daemon)["source"], "default");
  EXPECT_EQ(daemon.wait_until_done(daemon.start(quick))["state"], "finished");
}

TEST(RigCalibration, RefusesABodyThatIsNone) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  for (const char* const body :
       {"{}", R"({"kind": "dance"})", R"({"kind": "turn", "stops": 3})",
        R"({"kind": "turn", "stops": 73})", R"({"kind": "turn", "a": 1})"}) {
    EXPECT_EQ(daemon.post(calibration_path, body).status, 400) << body;
  }
  EXPECT_EQ(get(daemon)["run"], nullptr);
}

TEST(RigCalibration, ShowsThePointsThatTheSensorSees) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json seen = parsed(daemon.get("/api/v1/preview/points"));
  EXPECT_EQ(seen["sensor"]["width"], 640);
  EXPECT_NEAR(seen["sensor"]["fx"].get<double>(), 575.8, 0.001);  // OpenNI2 has it as a float
  // Every eighth pixel of each row and column; platform and object fill a good part of the frame.
  EXPECT_GT(seen["points_mm"].size(), 1000U);
  EXPECT_LE(seen["points_mm"].size(), 4800U);
  for (const json& point : seen["points_mm"]) {
    EXPECT_GT(point[2], 400);  // mm, a Kinect's nearest depth
  }
}

TEST(CalibrateRigCommand, TurnsAndStoresThePose) {
  const TemporaryFolder folder;
  std::vector<std::string> words{
      octurn_program(), "calibrate", "--simulate", "--simulate-speed", "20",
      "--stops",        "8",         "--json",     "--data",           folder.path() / "data"};
  for (const std::string& word : wrongly_told(folder)) {
    words.push_back(word);
  }
  Program program(words);
  EXPECT_EQ(program.wait(), 0) << program.errors();
  const json report = json::parse(program.output());
  EXPECT_EQ(report["accepted"], true);
  EXPECT_TRUE(report["platform_from_sensor"].is_array());
  const json stored = json::parse(content_of(folder.path() / "data" / "calibration.json"));
  EXPECT_EQ(stored["poses"][0]["source"], "turn");
  EXPECT_EQ(stored["poses"][0]["platform_from_sensor"], report["platform_from_sensor"]);
}

TEST(CalibrateRigCommand, EndsAtASignalAndStoresNothing) {
  const TemporaryFolder folder;
  Program program({octurn_program(), "calibrate", "--simulate", "--simulate-speed", "1", "--stops",
                   "72", "--data", folder.path() / "data"});
  while (!fs::exists(folder.path() / "data" / "platform.json")) {
    std::this_thread::yield();  // until it turns
  }
  program.send_signal(SIGINT);
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.errors().find("nothing was solved"), std::string::npos) << program.errors();
  EXPECT_FALSE(fs::exists(folder.path() / "data" / "calibration.json"));
}

}  // namespace
}  // namespace octurn
