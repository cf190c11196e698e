// Deeply nested JSON from outside: each reader refuses it, also on a small stack.

#include "support/nested_json.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "support/daemon.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Bodies of at most 64 KiB with deep values at the top level and below known keys.
std::vector<std::string> deep_bodies(const std::vector<std::string>& keys) {
  std::vector<std::string> bodies;
  for (const std::size_t depth : {600U, 5'000U}) {
    for (const std::string& value : {nested_arrays(depth), nested_objects(depth)}) {
      bodies.push_back(value);
      for (const std::string& key : keys) {
        bodies.push_back("{\"" + key + "\": " + value + "}");
      }
    }
  }
  return bodies;
}

/// Contents of files, whose size is not limited.
std::vector<std::string> deep_files(const std::string& key) {
  constexpr std::size_t depth = 200'000;
  return {nested_arrays(depth), nested_objects(depth),
          "{\"" + key + "\": " + nested_arrays(depth) + "}",
          "{\"" + key + "\": " + nested_objects(depth) + "}"};
}

void expect_refused_with(const Reply& reply, const std::string& code) {
  EXPECT_EQ(reply.status, 400) << reply.body;
  EXPECT_EQ(parsed(reply)["code"], code) << reply.body;
}

TEST(NestedJson, IsRefusedInEveryBody) {
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "appliance" / "requests");
  Daemon daemon(folder.path(), {"--appliance", folder.path() / "appliance"});
  const std::string scan = daemon.start(quick);
  daemon.wait_until_done(scan);

  for (const std::string& body : deep_bodies({"snapshots", "filter", "clip_mm", "none"})) {
    expect_refused_with(daemon.post("/api/v1/scans", body), "bad-json");
  }
  for (const std::string& body : deep_bodies({"name"})) {
    expect_refused_with(request(daemon.port(), "PATCH", scan, body), "bad-json");
  }
  for (const std::string& body : deep_bodies({"name", "password", "country"})) {
    expect_refused_with(request(daemon.port(), "PUT", "/api/v1/wifi", body), "bad-json");
  }
  expect_refused_with(daemon.get(scan + "/Scan.stl?leaf_size_mm=" + nested_arrays(2'000)),
                      "bad-settings");

  EXPECT_EQ(parsed(daemon.get(scan))["state"], "finished");  // the daemon has not crashed
  daemon.program().send_signal(SIGTERM);
  EXPECT_EQ(daemon.program().wait(), 0);
}

TEST(NestedJson, IsRefusedInTheSettings) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "octurn.json";
  for (const std::string& text : deep_files("port")) {
    put(file, text);
    Program program({octurn_program(), "serve", "--simulate", "--config", file});
    EXPECT_EQ(program.wait(), 1);
    EXPECT_NE(program.errors().find("octurn.json"), std::string::npos) << program.errors();
  }
}

TEST(NestedJson, CostsOnlyTheScanWhoseFileHasIt) {
  const TemporaryFolder folder;
  std::string scan;
  {
    const Daemon daemon(folder.path());
    scan = daemon.start(quick);
    daemon.wait_until_done(scan);
  }
  const std::string id = scan.substr(scan.rfind('/') + 1);
  for (const std::string& text : deep_files("settings")) {
    put(folder.path() / "data" / "scans" / id / "job.json", text);
    put(folder.path() / "data" / "platform.json", text);
    const Daemon daemon(folder.path());
    EXPECT_EQ(parsed(daemon.get(scan))["error"]["code"], "job-malformed");
    EXPECT_EQ(daemon.wait_until_done(daemon.start(quick))["state"], "finished");
  }
}

TEST(NestedJson, IsRefusedInARecording) {
  const TemporaryFolder folder;
  for (const std::string& text : deep_files("sensor")) {
    put(folder.path() / "recording.json", text);
    Program program({octurn_program(), "record", "--sensor", folder.path(), "-o",
                     folder.path() / "copy", "--snapshots", "1"});
    EXPECT_EQ(program.wait(), 1);
    EXPECT_NE(program.errors().find("recording.json"), std::string::npos) << program.errors();
  }
}

TEST(NestedJson, IsRefusedInAScanFolder) {
  const TemporaryFolder folder;
  for (const std::string& text : deep_files("snapshots")) {
    put(folder.path() / "scan.json", text);
    Program program(
        {octurn_program(), "reconstruct", folder.path(), "-o", folder.path() / "a.stl"});
    EXPECT_EQ(program.wait(), 1);
    EXPECT_NE(program.errors().find("scan.json"), std::string::npos) << program.errors();
  }
}

}  // namespace
}  // namespace octurn
