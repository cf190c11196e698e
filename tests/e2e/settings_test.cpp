// Settings that the page has stored, over HTTP and across restarts.

#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "support/daemon.hpp"
#include "support/digest_client.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string settings_path = "/api/v1/settings";

Reply patch(const Daemon& daemon, const json& change) {
  return request(daemon.port(), "PATCH", settings_path, change.dump());
}

/// The daemon's response to a GET of the settings; status 0 while it restarts.
Reply answer(const Daemon& daemon) {
  const FileDescriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const sockaddr_in address = internet_address(INADDR_LOOPBACK, daemon.port());
  if (::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) !=
      0) {
    return {};
  }
  send_text(socket, "GET " + settings_path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  return reply_from(receive_all(socket));
}

/// The first response that is as wanted; the last one if there is none within `patience`.
Reply wait_for(const Daemon& daemon, const std::function<bool(const Reply&)>& wanted) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  Reply reply = answer(daemon);
  while (!wanted(reply) && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
    reply = answer(daemon);
  }
  return reply;
}

/// The settings once none needs a restart.
json settled(const Daemon& daemon) {
  return parsed(wait_for(daemon, [](const Reply& reply) {
    return reply.status == 200 && parsed(reply)["restart_needed"].empty();
  }));
}

TEST(Settings, AreToldWithWhatIsAllowed) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json now = parsed(daemon.get(settings_path));
  EXPECT_EQ(now["settings"]["turntable"]["gear_ratio"], 1.0);
  EXPECT_EQ(now["stored"], json::object());
  EXPECT_EQ(now["restart_needed"], json::array());
  EXPECT_EQ(now["defaults"], now["settings"]["scan"]);
  const json keys = now["settings_schema"]["properties"];
  EXPECT_EQ(keys["turntable"]["properties"]["gear_ratio"]["x-unit"],
            "motor turns in a platform turn");
  EXPECT_EQ(keys["scan"]["properties"], now["schema"]["properties"]);
}

TEST(Settings, OfAScanAreInForceAtOnceAndAfterARestart) {
  const TemporaryFolder folder;
  std::optional<Daemon> daemon(std::in_place, folder.path());
  const Reply reply = patch(*daemon, {{"scan", {{"snapshots", 3}, {"leaf_size_mm", 4}}}});
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(parsed(reply)["restart_needed"], json::array());
  EXPECT_EQ(parsed(daemon->get(daemon->start("{}")))["snapshots_total"], 3);
  daemon.reset();  // killed
  daemon.emplace(folder.path());
  EXPECT_EQ(parsed(daemon->get(settings_path))["defaults"]["snapshots"], 3);
  ASSERT_EQ(patch(*daemon, {{"scan", {{"snapshots", nullptr}}}}).status, 200);
  EXPECT_EQ(parsed(daemon->get(settings_path))["defaults"]["snapshots"], 36);
  EXPECT_EQ(parsed(daemon->get(settings_path))["stored"], json({{"scan", {{"leaf_size_mm", 4}}}}));
}

TEST(Settings, ThatNeedARestartGetOneAtTheSameAddress) {
  const TemporaryFolder folder;
  Daemon daemon(folder.path());
  const Reply reply = patch(daemon, {{"turntable", {{"gear_ratio", 3}}}, {"threads", 1}});
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(parsed(reply)["restart_needed"], json({"threads", "turntable.gear_ratio"}));
  const json now = settled(daemon);
  EXPECT_EQ(now["settings"]["turntable"]["gear_ratio"], 3.0);
  EXPECT_EQ(now["settings"]["threads"], 1);
  EXPECT_EQ(daemon.wait_until_done(daemon.start(quick))["state"], "finished");
  daemon.program().send_signal(SIGTERM);
  EXPECT_EQ(daemon.program().wait(), 0);
}

TEST(Settings, WaitForTheEndOfAScan) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  ASSERT_EQ(patch(daemon, {{"threads", 1}}).status, 200);
  daemon.wait_until(scan, [](const json& now) { return now["snapshots_done"] >= 2; });
  EXPECT_EQ(parsed(daemon.get(settings_path))["restart_needed"], json({"threads"}));
  daemon.post(scan + "/cancel");
  EXPECT_EQ(settled(daemon)["settings"]["threads"], 1);
  EXPECT_EQ(parsed(daemon.get(scan))["state"], "cancelled");
}

TEST(Settings, AreRefusedByTheirKey) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  for (const char* const body :
       {R"({"turntable": {"gear_ratio": 0}})", R"({"turntable": {"gear_ratoi": 2}})",
        R"({"turntable": 5})", R"({"data": "/tmp"})", R"([1])", R"({"scan": {"clip_mm": [1]}})"}) {
    const Reply reply = request(daemon.port(), "PATCH", settings_path, body);
    EXPECT_EQ(reply.status, 400) << body;
    EXPECT_EQ(parsed(reply)["code"], "bad-settings") << body;
    EXPECT_NE(parsed(reply)["detail"], "") << body;
  }
  EXPECT_EQ(request(daemon.port(), "PATCH", settings_path, "{").status, 400);
  EXPECT_EQ(parsed(daemon.get(settings_path))["stored"], json::object());
  EXPECT_FALSE(fs::exists(folder.path() / "data" / "settings.json"));
}

TEST(Settings, ComeBackFromABackup) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  patch(daemon, {{"scan", {{"frames", 7}}}});
  const Reply backup = daemon.get(settings_path + "/backup");
  EXPECT_NE(backup.header("Content-Disposition").find("octurn-settings-"), std::string::npos);
  patch(daemon, {{"scan", {{"frames", 9}, {"snapshots", 5}}}});
  const Reply reply = daemon.post(settings_path + "/backup", backup.body);
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(parsed(reply)["stored"], json({{"scan", {{"frames", 7}}}}));
  for (const char* const body :
       {"{}", R"({"format": "octurn-settings", "version": 2, "settings": {}})",
        R"({"format": "octurn-settings", "version": 1, "settings": {"scan": {"frames": 0}}})",
        R"({"format": "octurn-settings", "version": 1, "settings": []})"}) {
    EXPECT_EQ(daemon.post(settings_path + "/backup", body).status, 400) << body;
  }
  EXPECT_EQ(parsed(daemon.get(settings_path))["stored"], json({{"scan", {{"frames", 7}}}}));
}

TEST(Settings, OfABackupContainNoKeyAndNoPasswordNorDoDiagnostics) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string key =
      parsed(daemon.post("/api/v1/keys", R"({"name": "Script", "access": "full"})"))["key"];
  daemon.post("/api/v1/webhooks", R"({"url": "http://127.0.0.1:9/hook?secret=canary"})");
  daemon.post("/api/v1/printers", R"({"name": "Prusa", "kind": "octoprint",
                                      "url": "http://127.0.0.1:9", "key": "canary"})");
  ASSERT_EQ(
      request(daemon.port(), "PUT", settings_path + "/password", R"({"password": "canary bird"})")
          .status,
      200);
  const std::string hash = digest_hash("octurn", "Octurn", "canary bird");
  // Files of diagnostics.zip are stored as they are.
  for (const std::string path : {"settings/backup", "diagnostics.zip", "webhooks", "printers"}) {
    const Reply reply = daemon.get("/api/v1/" + path, {{"Authorization", "Bearer " + key}});
    ASSERT_EQ(reply.status, 200) << reply.body;
    for (const std::string& secret :
         {std::string("canary"), hash, key.substr(key.rfind('-') + 1)}) {
      EXPECT_EQ(reply.body.find(secret), std::string::npos) << path << ": " << secret;
    }
  }
  const std::string addresses = content_of(folder.path() / "data" / "addresses.json");
  EXPECT_NE(addresses.find("secret=canary"), std::string::npos) << addresses;
  EXPECT_NE(addresses.find("octoprint"), std::string::npos) << addresses;
}

TEST(Settings, ThatAreDamagedAreToldAndTheLastGoodAreUsed) {
  const TemporaryFolder folder;
  std::optional<Daemon> daemon(std::in_place, folder.path());
  patch(*daemon, {{"scan", {{"frames", 7}}}});
  daemon.reset();
  daemon.emplace(folder.path());  // serves with the stored settings
  daemon.reset();
  put(folder.path() / "data" / "settings.json", R"({"scan": {"fra)");
  daemon.emplace(folder.path());
  EXPECT_EQ(parsed(daemon->get(settings_path))["defaults"]["frames"], 7);
  const json report = parsed(daemon->get("/api/v1/doctor"));
  const auto finding = std::ranges::find(report["findings"], "settings",
                                         [](const json& one) { return one["check"]; });
  ASSERT_NE(finding, report["findings"].end());
  EXPECT_EQ((*finding)["state"], "warning");
  EXPECT_NE((*finding)["measured"].get<std::string>().find("settings.json"), std::string::npos);
}

TEST(Settings, ThatItCannotServeWithAreUndone) {
  const TemporaryFolder folder;
  const Daemon other(folder.path() / "other");
  // Without --port, which would override the page's setting.
  std::vector<std::string> command = Daemon::command(folder.path());
  const auto option = std::ranges::find(command, "--port");
  command.erase(option, option + 2);
  put(folder.path() / "octurn.json", R"({"port": 0})");
  command.insert(command.end(), {"--config", folder.path() / "octurn.json"});
  const Daemon daemon(command);
  ASSERT_EQ(patch(daemon, {{"port", other.port()}}).status, 200);
  const json now = settled(daemon);
  EXPECT_EQ(now["stored"], json::object());
  EXPECT_EQ(now["settings"]["port"], 0);
}

TEST(Settings, GiveThePageAPassword) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  daemon.start(endless);  // a restart would wait for its end
  const auto set = [&](const char* body) {
    return request(daemon.port(), "PUT", settings_path + "/password", body);
  };
  EXPECT_EQ(set(R"({"password": ""})").status, 400);
  EXPECT_EQ(set(R"({"password": "sevenxx"})").status, 400);
  EXPECT_EQ(set(R"({"password": "open\u0000sesame"})").status, 400);
  EXPECT_EQ(set(R"({"password": 5})").status, 400);
  EXPECT_EQ(set("{}").status, 400);
  EXPECT_EQ(parsed(daemon.get(settings_path))["password"], "everybody");
  const Reply reply = set(R"({"password": "open sesame"})");
  ASSERT_EQ(reply.status, 200) << reply.body;
  EXPECT_EQ(parsed(reply)["password"], "page");
  const Reply locked = daemon.get("/api/v1/status");
  ASSERT_EQ(locked.status, 401);  // at once, without a restart
  EXPECT_EQ(content_of(folder.path() / "data" / "page-password").find("sesame"), std::string::npos);
  const std::string nonce = quoted_field(locked.header("WWW-Authenticate"), "nonce");
  const std::string proof =
      proof_of("open sesame", nonce, {.method = "PUT", .target = settings_path + "/password"});
  const Reply removed = request(daemon.port(), "PUT", settings_path + "/password",
                                R"({"password": null})", {{"Authorization", proof}});
  EXPECT_EQ(removed.status, 200) << removed.body;
  EXPECT_EQ(daemon.get("/api/v1/status").status, 200);
}

// As the page does, so that the password itself is not on the wire.
TEST(Settings, GiveThePageAPasswordByItsHash) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const auto set = [&](const json& body) {
    return request(daemon.port(), "PUT", settings_path + "/password", body.dump()).status;
  };
  const std::string hash = digest_hash("octurn", "Octurn", "open sesame");
  EXPECT_EQ(set({{"hash", "open sesame"}}), 400);
  EXPECT_EQ(set({{"hash", hash.substr(1)}}), 400);
  EXPECT_EQ(set({{"hash", hash + "\nother:Octurn:" + hash}}), 400);
  EXPECT_EQ(set({{"hash", hash}, {"password", "open sesame"}}), 400);
  EXPECT_EQ(set({{"hash", nullptr}}), 400);
  ASSERT_EQ(daemon.get("/api/v1/status").status, 200);
  ASSERT_EQ(set({{"hash", hash}}), 200);
  const Reply locked = daemon.get("/api/v1/status");
  ASSERT_EQ(locked.status, 401);
  const std::string nonce = quoted_field(locked.header("WWW-Authenticate"), "nonce");
  const std::string proof = proof_of("open sesame", nonce, {.target = "/api/v1/status"});
  EXPECT_EQ(daemon.get("/api/v1/status", {{"Authorization", proof}}).status, 200);
}

}  // namespace
}  // namespace octurn
