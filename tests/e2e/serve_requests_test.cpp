// The daemon's responses to unusual requests, and to requests from other origins.

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "support/daemon.hpp"
#include "support/http_client.hpp"
#include "support/patience.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

using nlohmann::json;

TEST(ServeRequests, ChangesNothingForASettingThatIsWrong) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  for (const char* const body :
       {R"({"snapshots": 0})", R"({"leaf_size_mm": "fine"})", R"({"speed": 1})", "[]", "nonsense",
        R"({"snapshots": 1e999})", "\xff\xfe"}) {
    const Reply reply = daemon.post("/api/v1/scans", body);
    EXPECT_EQ(reply.status, 400) << body;
    EXPECT_EQ(reply.header("Content-Type"), "application/problem+json");
  }
  const std::string deep(60'000, '[');
  EXPECT_EQ(daemon.post("/api/v1/scans", deep).status, 400);
  EXPECT_EQ(daemon.status()["scan"], nullptr);
  EXPECT_TRUE(parsed(daemon.get("/api/v1/scans"))["scans"].empty());
}

TEST(ServeRequests, ServesThePageAndNothingBesideIt) {
  const TemporaryFolder folder;
  put(folder.path() / "secret.txt", "treasure");
  const Daemon daemon(folder.path());
  const Reply page = daemon.get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.header("Content-Type"), "text/html; charset=utf-8");
  EXPECT_EQ(daemon.get("/", {{"If-None-Match", page.header("ETag")}}).status, 304);
  for (const char* const path :
       {"/../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/%2e%2e%2fsecret.txt",
        "//secret.txt", "/web/../../secret.txt", "/..\\secret.txt", "/api/v1/scans/..%2f..%2fweb",
        "/api/v1/scans/%2e%2e", "/api/v1/scans/../../web",
        "/api/v1/scans/20261121-081500-3f2a/../../../web/index.html",
        "/api/v1/scans/..%2f..%2f/Scan.stl", "/api/v1/scans//Scan.stl", "/api/v1/", "/api"}) {
    const Reply reply = daemon.get(path);
    EXPECT_TRUE(reply.status == 404 || reply.status == 400) << path << " " << reply.status;
    EXPECT_EQ(reply.body.find("treasure"), std::string::npos);
  }
}

TEST(ServeRequests, RefusesOtherSites) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const auto post = [&](const Headers& headers) {
    return request(daemon.port(), "POST", "/api/v1/scans", quick, headers).status;
  };
  EXPECT_EQ(post({{"Origin", "http://evil.example"}}), 403);
  EXPECT_EQ(post({{"Origin", "null"}}), 403);
  const std::string form =
      "POST /api/v1/scans HTTP/1.1\r\nHost: localhost\r\nContent-Type: text/plain\r\n"
      "Content-Length: 2\r\n\r\n{}";
  EXPECT_EQ(reply_to(daemon.port(), form).status, 415);
  const std::string rebound = "GET /api/v1/status HTTP/1.1\r\nHost: evil.example\r\n\r\n";
  EXPECT_EQ(reply_to(daemon.port(), rebound).status, 421);
  EXPECT_TRUE(parsed(daemon.get("/api/v1/scans"))["scans"].empty());
  EXPECT_EQ(post({{"Origin", "http://localhost:" + std::to_string(daemon.port())}}), 202);
}

// The host of a target that is a URL is the one that counts (RFC 9112, section 3.2.2).
TEST(ServeRequests, JudgesTheHostOfAnAbsoluteTargetAndNotTheHeader) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const auto status = [&](const std::string& host, const std::string& header) {
    return reply_to(daemon.port(), "GET http://" + host + ":" + std::to_string(daemon.port()) +
                                       "/api/v1/status HTTP/1.1\r\nHost: " + header + "\r\n\r\n")
        .status;
  };
  EXPECT_EQ(status("localhost", "localhost"), 200);
  EXPECT_EQ(status("octurn.local", "evil.example"), 200);
  EXPECT_EQ(status("evil.example", "localhost"), 421);
}

TEST(ServeRequests, StartsAScanBesideArchivesThatComeSlowly) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  std::vector<FileDescriptor> senders;
  std::vector<pollfd> answers;
  for (int i = 0; i < 6; ++i) {
    senders.push_back(connected(daemon.port()));
    send_text(senders.back(),
              "POST /api/v1/scans/import HTTP/1.1\r\nHost: localhost\r\n"
              "Content-Type: application/zip\r\nContent-Length: 1000000\r\n\r\nPK");
    answers.push_back({.fd = senders.back().number(), .events = POLLIN, .revents = 0});
  }
  // All places for archives are taken: some wait for their bytes, and the others are refused.
  ASSERT_GT(::poll(answers.data(), answers.size(), -1), 0);
  const auto answered = std::ranges::find_if(answers, &pollfd::revents);
  const auto refused = static_cast<std::size_t>(answered - answers.begin());
  EXPECT_EQ(reply_from(receive_all(senders[refused])).status, 503);
  EXPECT_EQ(daemon.wait_until_done(daemon.start(quick))["state"], "finished");
}

TEST(ServeRequests, SaysWhatAPathTakes) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const Reply wrong = request(daemon.port(), "PUT", "/api/v1/scans");
  EXPECT_EQ(wrong.status, 405);
  EXPECT_EQ(wrong.header("Allow"), "GET, HEAD, POST");
  EXPECT_EQ(request(daemon.port(), "DELETE", "/api/v1/status").status, 405);
  EXPECT_EQ(request(daemon.port(), "POST", "/").status, 404);
  EXPECT_EQ(parsed(daemon.get("/api/v1/scans/20261121-081500-3f2a"))["code"], "no-such-scan");
  const json settings = parsed(daemon.get("/api/v1/settings"));
  EXPECT_EQ(settings["defaults"]["snapshots"], 36);
  EXPECT_EQ(settings["schema"]["properties"]["snapshots"]["maximum"], 400);
  EXPECT_EQ(settings["schema"]["properties"].size(), settings["defaults"].size());
}

TEST(ServeRequests, UsesItsConfiguration) {
  const TemporaryFolder folder;
  put(folder.path() / "octurn.json",
      R"({"scan": {"snapshots": 5}, "host_names": ["scan.example"]})");
  const Daemon daemon(folder.path(), {"--config", folder.path() / "octurn.json"});
  EXPECT_EQ(parsed(daemon.get("/api/v1/settings"))["defaults"]["snapshots"], 5);
  const std::string named = "GET /api/v1/status HTTP/1.1\r\nHost: scan.example\r\n\r\n";
  EXPECT_EQ(reply_to(daemon.port(), named).status, 200);
}

TEST(ServeRequests, StartsNothingForARequestThatIsCutOff) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const FileDescriptor socket = connected(daemon.port());
  send_text(socket,
            "POST /api/v1/scans HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
            "Content-Length: 300\r\n\r\n");
  ::shutdown(socket.number(), SHUT_WR);
  EXPECT_EQ(reply_from(receive_all(socket)).status, 400);
  EXPECT_TRUE(parsed(daemon.get("/api/v1/scans"))["scans"].empty());
}

/// Requests a model that is built on demand, once the previous one has ended: its last byte arrives
/// before the builder is free.
Reply made_model(const Daemon& daemon, const std::string& path) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  Reply reply = daemon.get(path);
  while (reply.status == 409 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    reply = daemon.get(path);
  }
  return reply;
}

TEST(ServeRequests, MakesAModelByTheParametersOfTheQuery) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick);
  ASSERT_EQ(daemon.wait_until_done(scan)["state"], "finished");
  const std::string model = scan + "/Scan.stl";
  const std::string coarse = daemon.get(model + "?leaf_size_mm=8").body;
  EXPECT_LT(triangles_of_whole_stl(coarse), triangles_of_whole_stl(daemon.get(model).body) / 2);
  EXPECT_TRUE(made_model(daemon, model + "?leaf%5Fsize_mm=%38").body == coarse);
  for (const char* const query :
       {"?x=1", "?leaf_size_mm", "?leaf_size_mm=", "?leaf_size_mm=fine", "?=8", "?&",
        "?leaf_size_mm=8&leaf_size_mm=8", "?leaf_size_mm=8&level=2&a=1"}) {
    EXPECT_EQ(daemon.get(model + query).status, 400) << query;
  }
}

TEST(ServeRequests, CountsTheCharactersOfANameAndNotItsBytes) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(quick);
  const auto name_of = [](int characters) {
    std::string name;
    for (int i = 0; i < characters; ++i) {
      name += "\u732b";  // three bytes
    }
    return json{{"name", name}}.dump();
  };
  EXPECT_EQ(request(daemon.port(), "PATCH", scan, name_of(100)).status, 200);
  EXPECT_EQ(request(daemon.port(), "PATCH", scan, name_of(101)).status, 400);
}

TEST(ServeRequests, LeadsNobodyFromTheInterfaceToThePage) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const Reply reply = daemon.get("/api/v1/nothing");
  EXPECT_EQ(reply.status, 404);
  EXPECT_NE(parsed(reply)["hint"].get<std::string>().find("/api/v1/"), std::string::npos);
}

}  // namespace
}  // namespace octurn
