// Further models of a stored scan, built over HTTP.

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/daemon.hpp"
#include "support/stl.hpp"
#include "support/wrong_pose.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A scan with a wrong sensor pose.
json askew_scan(const Daemon& daemon) {
  return daemon.wait_until_done(daemon.start(json{
      {"snapshots", 12},
      {"frames", 2},
      {"leaf_size_mm", 1},
      {"calibrate", "told"},
      {"platform_from_sensor",
       to_rows(wrong_pose())}}.dump()));
}

std::string path_to(const json& scan) { return "/api/v1/scans/" + scan["id"].get<std::string>(); }

fs::path folder_of(const TemporaryFolder& folder, const json& scan) {
  return folder.path() / "data" / "scans" / scan["id"].get<std::string>();
}

bool has_ended(const json& build) {
  return build["state"] != "waiting" && build["state"] != "running";
}

/// Begins a build. @return its path
std::string begin(const Daemon& daemon, const json& scan, const json& settings) {
  const Reply reply = daemon.post(path_to(scan) + "/builds", settings.dump());
  EXPECT_EQ(reply.status, 202) << reply.body;
  return reply.header("Location");
}

json build(const Daemon& daemon, const json& scan, const json& settings) {
  return daemon.wait_until(begin(daemon, scan, settings), has_ended);
}

json builds_of(const Daemon& daemon, const json& scan) {
  return parsed(daemon.get(path_to(scan) + "/builds"))["builds"];
}

/// Settings of a build that takes long.
const json fine{{"leaf_size_mm", 0.2}, {"method", "intersection"}};

bool reads(const json& build) { return build["phase"] == "building" || has_ended(build); }

TEST(Builds, StraightenAScanThatWentByAWrongPose) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json scan = askew_scan(daemon);
  ASSERT_EQ(scan["state"], "finished") << scan;
  EXPECT_EQ(scan["model"]["quality"]["verdict"], "bad") << scan;
  EXPECT_EQ(scan["build"], 0);
  const std::string askew = daemon.get(path_to(scan) + "/Scan.stl").body;
  const std::string taken = content_of(folder_of(folder, scan) / "scan.json");

  const json straight = build(daemon, scan, {{"calibrate", "auto"}, {"choose", true}});
  ASSERT_EQ(straight["state"], "finished") << straight;
  EXPECT_EQ(straight["build"], 1);
  EXPECT_EQ(straight["chosen"], true);
  EXPECT_EQ(straight["settings"]["calibrate"], "auto");
  EXPECT_EQ(straight["settings"]["leaf_size_mm"], 1);
  EXPECT_EQ(straight["calibration"]["accepted"], true) << straight;
  // Twelve stops of a sensor without a map may lose the flag. That is the only reason reported.
  for (const json& reason : straight["model"]["quality"]["reasons"]) {
    EXPECT_EQ(reason["code"], "part-missing") << straight;
  }
  const std::string model = daemon.get(straight["model"]["url"]).body;
  EXPECT_EQ(open_edges(model), 0);

  // The build is the scan's model now. The first model and all stored files are still there.
  const json now = parsed(daemon.get(path_to(scan)));
  EXPECT_EQ(now["build"], 1);
  EXPECT_EQ(now["model"]["quality"], straight["model"]["quality"]);
  EXPECT_TRUE(daemon.get(path_to(scan) + "/Scan.stl").body == model);
  EXPECT_TRUE(daemon.get("/Scan.stl").body == model);
  EXPECT_TRUE(daemon.get(path_to(scan) + "/builds/0/Scan.stl").body == askew);
  EXPECT_EQ(content_of(folder_of(folder, scan) / "scan.json"), taken);

  // The command gives the same model from the stored scan.
  Program again({octurn_program(), "reconstruct", folder_of(folder, scan), "-o", "-",
                 "--leaf-size-mm", "1", "--method", "solid"});
  EXPECT_EQ(again.wait(), 0) << again.errors();
  EXPECT_TRUE(again.output() == model);
}

TEST(Builds, AreListedChosenAndDeletedAndOutliveTheProgram) {
  const TemporaryFolder folder;
  json scan;
  json same;
  json coarse;
  {
    const Daemon daemon(folder.path());
    scan = daemon.wait_until_done(daemon.start(quick));
    ASSERT_EQ(scan["state"], "finished") << scan;
    same = build(daemon, scan, json::object());
    EXPECT_TRUE(daemon.get(same["model"]["url"]).body ==
                daemon.get(path_to(scan) + "/Scan.stl").body)
        << "the same settings make the same model";
    EXPECT_EQ(same["chosen"], false);
    coarse = build(daemon, scan, {{"leaf_size_mm", 8}, {"clip_mm", {-140, -140, 5, 140, 140, 60}}});
    ASSERT_EQ(coarse["state"], "finished") << coarse;
    EXPECT_LT(coarse["model"]["size_mm"][2], 70);
    EXPECT_GT(scan["model"]["size_mm"][2], 70);
    EXPECT_EQ(daemon.post(path_to(scan) + "/builds/2/choose").status, 200);
  }
  const Daemon daemon(folder.path());
  const json all = builds_of(daemon, scan);
  ASSERT_EQ(all.size(), 3U) << all;
  EXPECT_EQ(all[0]["model"]["triangles"], scan["model"]["triangles"]);
  EXPECT_EQ(all[0]["chosen"], false);
  EXPECT_EQ(all[1], same);
  coarse["chosen"] = true;
  EXPECT_EQ(all[2], coarse);
  EXPECT_EQ(parsed(daemon.get(path_to(scan)))["model"]["triangles"], coarse["model"]["triangles"]);

  const auto remove = [&](const std::string& build) {
    return request(daemon.port(), "DELETE", path_to(scan) + "/builds/" + build).status;
  };
  EXPECT_EQ(remove("2"), 409) << "it is the scan's model";
  EXPECT_EQ(remove("0"), 409) << "it belongs to the scan";
  EXPECT_EQ(remove("9"), 404);
  EXPECT_EQ(remove("1"), 204);
  EXPECT_EQ(remove("1"), 404);
  EXPECT_FALSE(fs::exists(folder_of(folder, scan) / "builds" / "1"));
  EXPECT_EQ(daemon.get(path_to(scan) + "/builds/1/Scan.stl").status, 404);
  EXPECT_EQ(daemon.post(path_to(scan) + "/builds/0/choose").status, 200);
  EXPECT_EQ(remove("2"), 204);
  EXPECT_EQ(builds_of(daemon, scan).size(), 1U);
  EXPECT_EQ(parsed(daemon.get(path_to(scan)))["model"], scan["model"]);
}

TEST(Builds, RefuseWhatIsWrong) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json scan = daemon.wait_until_done(daemon.start(quick));
  for (const char* const body :
       {R"({"leaf_size_mm": 0})", R"({"snapshots": 4})", R"({"choose": 1})", R"({"level": 99})",
        R"({"calibrate": "again"})", R"({"platform_from_sensor": [1]})", "[]"}) {
    const Reply reply = daemon.post(path_to(scan) + "/builds", body);
    EXPECT_EQ(reply.status, 400) << body;
    EXPECT_EQ(parsed(reply)["code"], "bad-settings") << body;
  }
  EXPECT_EQ(daemon.post("/api/v1/scans/20261121-081500-3f2a/builds").status, 404);
  EXPECT_EQ(daemon.get(path_to(scan) + "/builds/1").status, 404);
  EXPECT_EQ(daemon.get(path_to(scan) + "/builds/01").status, 404);
  EXPECT_EQ(daemon.post(path_to(scan) + "/builds/0/cancel").status, 409);
  const std::string running = daemon.start(endless);
  EXPECT_EQ(daemon.post(running + "/builds").status, 409) << "it has not ended";
  EXPECT_EQ(daemon.post(path_to(scan) + "/builds").status, 409) << "a scan runs";
  EXPECT_EQ(builds_of(daemon, scan).size(), 1U);
}

TEST(Builds, AreCancelledAndEndForAScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json scan = daemon.wait_until_done(daemon.start(quick));
  const std::string cancelled = begin(daemon, scan, fine);
  daemon.wait_until(cancelled, reads);
  EXPECT_EQ(daemon.post(path_to(scan) + "/builds", "{}").status, 409) << "one at a time";
  EXPECT_EQ(request(daemon.port(), "DELETE", path_to(scan)).status, 409);
  EXPECT_EQ(daemon.post(cancelled + "/cancel").status, 202);
  const json gone = daemon.wait_until(cancelled, has_ended);
  EXPECT_EQ(gone["state"], "cancelled");
  EXPECT_EQ(gone["error"], nullptr);
  EXPECT_EQ(daemon.status()["build"], gone);

  const std::string displaced = begin(daemon, scan, fine);
  daemon.wait_until(displaced, reads);
  const json other = daemon.wait_until_done(daemon.start(quick));
  EXPECT_EQ(other["state"], "finished") << other;
  const json ended = daemon.wait_until(displaced, has_ended);
  EXPECT_EQ(ended["state"], "cancelled");
  EXPECT_EQ(ended["error"]["code"], "busy") << ended;
  EXPECT_TRUE(fs::is_empty(folder_of(folder, scan) / "builds"));
  EXPECT_EQ(parsed(daemon.get(path_to(scan))), scan);
}

TEST(Builds, LeaveTheScanWholeWhenTheProgramIsKilled) {
  const TemporaryFolder folder;
  json scan;
  std::string model;
  {
    Daemon daemon(folder.path());
    scan = daemon.wait_until_done(daemon.start(quick));
    model = daemon.get(path_to(scan) + "/Scan.stl").body;
    daemon.wait_until(begin(daemon, scan, fine), reads);
    daemon.program().send_signal(SIGKILL);
    EXPECT_EQ(daemon.program().wait(), -SIGKILL);
    EXPECT_FALSE(fs::is_empty(folder_of(folder, scan) / "builds"));
  }
  const Daemon daemon(folder.path());
  EXPECT_EQ(parsed(daemon.get(path_to(scan))), scan);
  EXPECT_TRUE(daemon.get(path_to(scan) + "/Scan.stl").body == model);
  EXPECT_EQ(builds_of(daemon, scan).size(), 1U);
  EXPECT_TRUE(fs::is_empty(folder_of(folder, scan) / "builds"));
  EXPECT_EQ(build(daemon, scan, json::object())["state"], "finished");
}

TEST(Builds, GiveAScanAModelThatWasCancelled) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  daemon.wait_until(scan, [](const json& now) { return now["snapshots_done"] >= 3; });
  daemon.post(scan + "/cancel", "");
  const json cancelled = daemon.wait_until_done(scan);
  EXPECT_EQ(daemon.get(scan + "/Scan.stl").status, 404);
  const json built = build(daemon, cancelled, {{"calibrate", "told"}});
  ASSERT_EQ(built["state"], "finished") << built;
  EXPECT_EQ(built["chosen"], true);
  EXPECT_EQ(daemon.get(scan + "/Scan.stl").status, 200);
  EXPECT_EQ(parsed(daemon.get(scan))["state"], "cancelled");
}

}  // namespace
}  // namespace octurn
