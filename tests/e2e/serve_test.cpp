#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/daemon.hpp"
#include "support/http_client.hpp"
#include "support/program.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A scan as in the list: without the places in the verdict's reasons, which may be many.
json as_listed(json scan) {
  for (json& reason : scan["model"]["quality"]["reasons"]) {
    reason.erase("places_mm");
  }
  return scan;
}

class ServeByMethod : public ::testing::TestWithParam<const char*> {};

TEST_P(ServeByMethod, ScansAndGivesAClosedModel) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string method = GetParam();
  const std::string scan = daemon.start(
      json{{"snapshots", 8}, {"frames", 3}, {"leaf_size_mm", 2}, {"method", method}}.dump());
  const json done = daemon.wait_until_done(scan);
  ASSERT_EQ(done["state"], "finished") << done;
  EXPECT_EQ(done["phase"], "done");
  EXPECT_EQ(done["snapshots_done"], 8);
  EXPECT_EQ(done["model"]["watertight"], true);

  const Reply model = daemon.get(done["model"]["url"]);
  EXPECT_EQ(model.status, 200);
  EXPECT_EQ(model.header("Content-Type"), "model/stl");
  EXPECT_EQ(triangles_of_whole_stl(model.body), done["model"]["triangles"]);
  EXPECT_EQ(open_edges(model.body), 0);
  EXPECT_TRUE(daemon.get("/Scan.stl").body == model.body);
  EXPECT_EQ(daemon.status()["newest"], done["id"]);
  EXPECT_EQ(parsed(daemon.get("/api/v1/scans"))["scans"][0], as_listed(done));

  // The command gives the same bytes from the stored scan.
  Program again({octurn_program(), "reconstruct", folder.path() / "data" / "scans" / done["id"],
                 "-o", "-", "--leaf-size-mm", "2", "--method", method});
  EXPECT_EQ(again.wait(), 0);
  EXPECT_TRUE(again.output() == model.body);
  EXPECT_EQ(done["model"]["parts"], method == "solid" ? json(1) : json(nullptr));
}

INSTANTIATE_TEST_SUITE_P(Both, ServeByMethod, ::testing::Values("solid", "intersection"));

TEST(Serve, SendsPartsOfAModelThatPutTogetherAreTheWhole) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  ASSERT_EQ(daemon.wait_until_done(daemon.start(quick))["state"], "finished");
  const Reply whole = daemon.get("/Scan.stl");
  const std::string tag = whole.header("ETag");
  std::string together;
  const std::size_t half = whole.body.size() / 2;
  for (const std::string& part :
       {"bytes=0-" + std::to_string(half - 1), "bytes=" + std::to_string(half) + "-"}) {
    const Reply reply = daemon.get("/Scan.stl", {{"Range", part}, {"If-Range", tag}});
    EXPECT_EQ(reply.status, 206);
    together += reply.body;
  }
  EXPECT_TRUE(together == whole.body);
  EXPECT_EQ(daemon.get("/Scan.stl", {{"If-None-Match", tag}}).status, 304);
  EXPECT_EQ(daemon.get("/Scan.stl", {{"Range", "bytes=99999999999-"}}).status, 416);
  const Reply head = request(daemon.port(), "HEAD", "/Scan.stl");
  EXPECT_EQ(head.header("Content-Length"), std::to_string(whole.body.size()));
  EXPECT_EQ(head.body, "");
}

TEST(Serve, RefusesASecondStart) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  const Reply second = daemon.post("/api/v1/scans", quick);
  EXPECT_EQ(second.status, 409);
  EXPECT_EQ(second.header("Content-Type"), "application/problem+json");
  EXPECT_EQ(parsed(second)["code"], "busy");
  EXPECT_FALSE(parsed(second)["hint"].get<std::string>().empty());
  EXPECT_EQ(request(daemon.port(), "DELETE", scan).status, 409);
  EXPECT_EQ(parsed(daemon.get("/api/v1/scans"))["scans"].size(), 1U);
}

TEST(Serve, CancelsAScanWhereverItIs) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  for (const char* const phase : {"starting", "turning", "capturing"}) {
    const std::string scan = daemon.start(endless);
    daemon.wait_until(scan, [&](const json& now) {
      return now["phase"] == phase || std::string(phase) == "starting";
    });
    EXPECT_EQ(daemon.post(scan + "/cancel", "").status, 202) << phase;
    const json done = daemon.wait_until_done(scan);
    EXPECT_EQ(done["state"], "cancelled") << phase;
    EXPECT_EQ(parsed(daemon.get(scan + "/Scan.stl"))["code"], "no-model");
    const Reply again = daemon.post(scan + "/cancel", "");
    EXPECT_EQ(again.status, 409);
    EXPECT_EQ(parsed(again)["code"], "not-running");
  }
  EXPECT_EQ(daemon.wait_until_done(daemon.start(quick))["state"], "finished");
}

TEST(Serve, CancelsAScanWhileItBuilds) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan =  // its model has hundreds of megabytes and takes a while
      daemon.start(
          R"({"snapshots": 3, "frames": 1, "leaf_size_mm": 0.2, "method": "intersection"})");
  const json building = daemon.wait_until(scan, [](const json& now) {
    return now["phase"] == "building" || now["state"] != "running";
  });
  ASSERT_EQ(building["phase"], "building") << building;
  EXPECT_EQ(daemon.post(scan + "/cancel", "").status, 202);
  const json done = daemon.wait_until_done(scan);
  EXPECT_EQ(done["state"], "cancelled");
  EXPECT_EQ(done["snapshots_done"], 3);
  const fs::path scan_folder = folder.path() / "data" / "scans" / done["id"];
  EXPECT_FALSE(fs::exists(scan_folder / "Scan.stl"));
  EXPECT_EQ(std::distance(fs::directory_iterator(scan_folder), {}), 3);  // job, scan, snapshots
}

TEST(Serve, NamesNotesAndDeletesAScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick);
  daemon.wait_until_done(scan);
  const Reply named = request(daemon.port(), "PATCH", scan, R"({"name": "Hase"})");
  EXPECT_EQ(named.status, 200);
  EXPECT_EQ(parsed(named)["name"], "Hase");
  const Reply noted = request(daemon.port(), "PATCH", scan, R"({"notes": "of clay\n1920"})");
  EXPECT_EQ(parsed(noted)["notes"], "of clay\n1920");
  EXPECT_EQ(parsed(noted)["name"], "Hase");
  EXPECT_NE(daemon.get(scan + "/Scan.stl").header("Content-Disposition").find("Hase.stl"),
            std::string::npos);
  for (const char* const body :
       {R"({"name": 5})", R"({"nom": "x"})", R"({"name": "a\nb"})", "", "[]", "{",
        R"({"name": "\ud800"})", R"({"notes": 5})", R"({"notes": "a\u0007"})", R"({"tags": "a"})",
        R"({"tags": ["a", "a"]})", R"({"tags": [5]})", R"({"tags": ["a\nb"]})",
        R"({"author": null})", R"({"licence": "x", "nom": "x"})"}) {
    EXPECT_EQ(request(daemon.port(), "PATCH", scan, body).status, 400) << body;
  }
  EXPECT_EQ(parsed(daemon.get(scan))["name"], "Hase");

  EXPECT_EQ(request(daemon.port(), "DELETE", scan).status, 204);
  EXPECT_EQ(daemon.get(scan).status, 404);
  EXPECT_EQ(daemon.get("/Scan.stl").status, 404);
  EXPECT_TRUE(fs::is_empty(folder.path() / "data" / "scans"));
}

TEST(Serve, LabelsAScanAtItsStartAndListsItInATable) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  for (const char* const wrong :
       {R"({"snapshots": 3, "name": 5})", R"({"snapshots": 3, "tags": 5})"}) {
    EXPECT_EQ(parsed(daemon.post("/api/v1/scans", wrong))["code"], "bad-name") << wrong;
  }
  EXPECT_EQ(daemon.get("/api/v1/scans.zip").status, 404) << "there is no model";
  json body = json::parse(quick);
  body["name"] = "=Hase; \"3\"";
  body["tags"] = {"Grave 3", "plaster"};
  body["licence"] = "CC0";
  const std::string scan = daemon.start(body.dump());
  const json done = daemon.wait_until_done(scan);
  EXPECT_EQ(done["tags"], body["tags"]);
  EXPECT_EQ(done["licence"], "CC0");

  const std::string id = done["id"];
  const Reply table = daemon.get("/api/v1/scans.csv?ids=" + id + "," + id);
  EXPECT_EQ(table.header("Content-Type"), "text/csv; charset=utf-8");
  EXPECT_EQ(std::ranges::count(table.body, '\n'), 2) << "once, and the names of the columns";
  EXPECT_NE(table.body.find("\r\n\"" + id +
                            "\",\"'=Hase; \"\"3\"\"\",\"\",\"Grave 3, plaster\",\"\","
                            "\"CC0\",\"\","),
            std::string::npos)
      << table.body;
  EXPECT_EQ(daemon.get("/api/v1/scans.csv").body, table.body);
  const Reply models = daemon.get("/api/v1/scans.zip?format=ply&ids=" + id);
  EXPECT_EQ(models.header("Content-Type"), "application/zip");
  const Reply head = request(daemon.port(), "HEAD", "/api/v1/scans.zip?format=ply&ids=" + id);
  EXPECT_EQ(head.header("Content-Type"), "application/zip") << "it is asked for without packing";
  EXPECT_NE(models.body.find("=Hase; _3_.ply"), std::string::npos);
  EXPECT_NE(models.body.find(daemon.get(scan + "/Scan.ply").body), std::string::npos);
  for (const char* const query : {"ids=20261121-081500-3f2a", "ids=..", "ids="}) {
    EXPECT_EQ(daemon.get(std::string("/api/v1/scans.zip?") + query).status, 404) << query;
  }
  for (const char* const query : {"format=..", "format=doc", "id=", "format=stl&format=stl"}) {
    EXPECT_EQ(daemon.get(std::string("/api/v1/scans.zip?") + query).status, 400) << query;
  }
  for (const auto& entry : fs::directory_iterator(folder.path() / "data" / "scans")) {
    EXPECT_EQ(entry.path().filename(), id) << "no archive is left behind";
  }
}

TEST(Serve, ShowsWhatTheSensorSees) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const Reply picture = daemon.get("/api/v1/preview/depth.png");
  EXPECT_EQ(picture.status, 200) << picture.body;
  EXPECT_EQ(picture.header("Content-Type"), "image/png");
  EXPECT_EQ(picture.body.substr(1, 3), "PNG");
}

TEST(Serve, SaysThatThereIsNoSensor) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--sensor", "/nowhere.oni"});
  for (const Reply& reply :
       {daemon.get("/api/v1/preview/depth.png"), daemon.post("/api/v1/scans", quick)}) {
    EXPECT_EQ(reply.status, 503);
    EXPECT_EQ(parsed(reply)["code"], "sensor-missing");
    EXPECT_FALSE(parsed(reply)["hint"].get<std::string>().empty());
  }
  EXPECT_EQ(daemon.status()["sensor"]["state"], "missing");
}

// The settings name a line that no machine has, so nothing is driven even if there are GPIO lines.
TEST(Serve, SaysThatItHasNoTurntableAndGoesOn) {
  const TemporaryFolder folder;
  put(folder.path() / "octurn.json", R"({"turntable": {"step_line": "no such line"}})");
  std::vector<std::string> command = Daemon::command(folder.path());
  command.erase(std::ranges::find(command, "--simulate"), std::ranges::find(command, "--listen"));
  command.insert(command.end(),
                 {"--sensor", "octurn-simulator://", "--config", folder.path() / "octurn.json"});
  const Daemon daemon(std::move(command));
  const Reply refused = daemon.post("/api/v1/scans", quick);
  EXPECT_EQ(refused.status, 503);
  const std::string state = daemon.status()["turntable"]["state"];
  EXPECT_TRUE(state == "missing" || state == "failed") << state;
  EXPECT_EQ(parsed(refused)["code"], "turntable-" + state);
  EXPECT_FALSE(parsed(refused)["hint"].get<std::string>().empty());
  EXPECT_TRUE(parsed(daemon.get("/api/v1/scans"))["scans"].empty());
  EXPECT_EQ(daemon.get("/api/v1/preview/depth.png").status, 200);
}

TEST(Serve, FailsAScanWhenTheDiskIsFullAndGoesOn) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {}, {.file_bytes = 500'000});  // snapshots fit, no model does
  const json done = daemon.wait_until_done(daemon.start(R"({"snapshots": 3, "frames": 2})"));
  EXPECT_EQ(done["state"], "failed");
  EXPECT_EQ(done["error"]["code"], "disk-full");
  EXPECT_FALSE(done["error"]["hint"].get<std::string>().empty());
  EXPECT_EQ(done["snapshots_done"], 3);
  EXPECT_EQ(daemon.status()["scan"], nullptr);
}

TEST(Serve, KeepsToOneDaemonForAFolderAndForAPort) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  Program same_data(Daemon::command(folder.path()));
  EXPECT_EQ(same_data.wait(), 1);
  EXPECT_NE(same_data.errors().find("another octurn"), std::string::npos) << same_data.errors();

  const TemporaryFolder other;
  Program same_port(Daemon::command(other.path(), {}, daemon.port()));
  EXPECT_EQ(same_port.wait(), 1);
  EXPECT_NE(same_port.errors().find("cannot listen on 127.0.0.1"), std::string::npos);
  EXPECT_NE(same_port.errors().find("--port"), std::string::npos);
}

TEST(Serve, SaysWhatIsWrongBeforeItStarts) {
  const TemporaryFolder folder;
  put(folder.path() / "octurn.json", R"({"scan": {"leaf_size_mm": 0}})");
  Program bad_config(Daemon::command(folder.path(), {"--config", folder.path() / "octurn.json"}));
  EXPECT_EQ(bad_config.wait(), 1);
  EXPECT_NE(bad_config.errors().find("scan.leaf_size_mm"), std::string::npos);

  Program bad_port(Daemon::command(folder.path(), {}, 70000));
  EXPECT_EQ(bad_port.wait(), 2);
}

}  // namespace
}  // namespace octurn
