// Updates and WiFi through the daemon. The test plays the appliance's root services.

#include <gtest/gtest.h>
#include <sys/socket.h>

#include <filesystem>
#include <string>
#include <thread>

#include "support/daemon.hpp"
#include "support/upload.hpp"
#include "support/zip.hpp"
#include "version.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* wifi_path = "/api/v1/wifi";

/// A daemon on an appliance whose folder root has created.
class Appliances : public ::testing::Test {
 protected:
  fs::path answers() const { return folder_.path() / "appliance"; }
  fs::path requests() const { return answers() / "requests"; }

  Daemon daemon(const ProgramLimits& limits = {}) const {
    fs::create_directories(requests());
    return Daemon(folder_.path(), {"--appliance", answers()}, limits);
  }

  void answer(const std::string& name, const std::string& text) const {
    put(answers() / name, text);
  }

  TemporaryFolder folder_;
};

/// Sends a text, closes the sending side, and returns the response.
Reply reply_to_all_of(const Daemon& daemon, const std::string& text) {
  const FileDescriptor socket = connected(daemon.port());
  send_text(socket, text);
  ::shutdown(socket.number(), SHUT_WR);
  return reply_from(receive_all(socket));
}

/// An upload that has begun and stalls.
FileDescriptor begun_upload(const Daemon& daemon, std::size_t bytes, const std::string& part) {
  FileDescriptor socket = connected(daemon.port());
  send_text(socket, head_of_upload(bytes) + part);
  while (parsed(daemon.get(update_path))["state"] != "receiving") {
    std::this_thread::yield();
  }
  return socket;
}

TEST_F(Appliances, HandANameAndATimeZoneToRoot) {
  const Daemon scanner = daemon();
  answer("machine", "name = octurn\ntime_zone = Etc/UTC\nerror = \n");
  const std::string path = "/api/v1/machine";
  EXPECT_EQ(parsed(scanner.get(path)),
            json({{"name", "octurn"}, {"time_zone", "Etc/UTC"}, {"error", ""}}));
  const auto patch = [&](const char* body) { return request(scanner.port(), "PATCH", path, body); };
  for (const char* const wrong :
       {"{}", R"({"name": "my scanner"})", R"({"name": "-a"})", R"({"name": 5})",
        R"({"time_zone": "Europe/Berlin\nrig = simulated"})", R"({"rig": "simulated"})"}) {
    EXPECT_EQ(parsed(patch(wrong))["code"], "bad-settings") << wrong;
  }
  EXPECT_FALSE(fs::exists(requests() / "machine"));
  EXPECT_EQ(patch(R"({"name": "Shed-2", "time_zone": "Europe/Berlin"})").status, 202);
  EXPECT_EQ(content_of(requests() / "machine"), "name = shed-2\ntime_zone = Europe/Berlin\n");
}

TEST_F(Appliances, HandAnUpdateToRoot) {
  const Daemon scanner = daemon();
  answer("update", "slot = a\nstate = none\n");
  EXPECT_EQ(parsed(scanner.get(update_path)), (json{{"version", version()},
                                                    {"slot", "a"},
                                                    {"state", "none"},
                                                    {"update_version", ""},
                                                    {"error", ""}}));
  std::string bundle(3'000'001, '\0');
  for (std::size_t i = 0; i < bundle.size(); ++i) {
    bundle[i] = static_cast<char>(i * 31 >> 3);
  }
  const Reply reply = upload(scanner, bundle);
  EXPECT_EQ(reply.status, 202) << reply.body;
  EXPECT_EQ(parsed(reply)["state"], "installing");
  EXPECT_TRUE(content_of(requests() / "update") == bundle);
  EXPECT_EQ(std::distance(fs::directory_iterator(requests()), {}), 1);

  EXPECT_FALSE(fs::exists(requests() / "update.older"));
  fs::remove(requests() / "update");
  EXPECT_EQ(upload(scanner, bundle, {}, "?older=yes").status, 202);
  EXPECT_TRUE(fs::exists(requests() / "update.older"));
  fs::remove(requests() / "update");
  EXPECT_EQ(upload(scanner, bundle).status, 202);
  EXPECT_FALSE(fs::exists(requests() / "update.older"));
  fs::remove(requests() / "update");
  EXPECT_EQ(parsed(upload(scanner, bundle, {}, "?elder=yes"))["code"], "bad-settings");

  answer("update", "slot = a\nstate = failed\nversion = 0.2.0\nerror = It is not signed.\n");
  const json failed = parsed(scanner.get(update_path));
  EXPECT_EQ(failed["state"], "failed");
  EXPECT_EQ(failed["update_version"], "0.2.0");
  EXPECT_EQ(failed["error"], "It is not signed.");
}

TEST_F(Appliances, KeepNothingOfAnUpdateThatIsCutShort) {
  const Daemon scanner = daemon();
  const Reply reply = reply_to_all_of(scanner, head_of_upload(100'000) + std::string(99'999, 'x'));
  EXPECT_EQ(reply.status, 400);
  EXPECT_EQ(parsed(reply)["code"], "cut-short");
  EXPECT_NE(parsed(reply)["detail"].get<std::string>().find("99999 of 100000"), std::string::npos);
  EXPECT_TRUE(fs::is_empty(requests()));
  begun_upload(scanner, 100'000, "lost");  // closed at once
  while (parsed(scanner.get(update_path))["state"] != "none") {
    std::this_thread::yield();
  }
  EXPECT_TRUE(fs::is_empty(requests()));
}

TEST_F(Appliances, TakeOneUpdateAtATimeAndNoScanMeanwhile) {
  const Daemon scanner = daemon();
  const FileDescriptor first = begun_upload(scanner, 10, "12345");
  EXPECT_EQ(parsed(upload(scanner, "another"))["code"], "busy");
  EXPECT_EQ(parsed(scanner.post("/api/v1/scans", quick))["code"], "busy");
  send_text(first, "67890");
  EXPECT_EQ(reply_from(receive_all(first)).status, 202);
  EXPECT_EQ(content_of(requests() / "update"), "1234567890");
  EXPECT_EQ(upload(scanner, "another").status, 409);
  EXPECT_EQ(scanner.post("/api/v1/scans", quick).status, 409);
  EXPECT_EQ(content_of(requests() / "update"), "1234567890");
}

TEST_F(Appliances, TakeNoUpdateWhileAScanRuns) {
  const Daemon scanner = daemon();
  const std::string scan = scanner.start(endless);
  const Reply reply = upload(scanner, std::string(500'000, 'x'));
  EXPECT_EQ(reply.status, 409);
  EXPECT_EQ(parsed(reply)["code"], "busy");
  EXPECT_TRUE(fs::is_empty(requests()));
  EXPECT_EQ(parsed(scanner.get(scan))["state"], "running");
}

TEST_F(Appliances, RefuseUpdatesThatAreNone) {
  const Daemon scanner = daemon();
  const Reply large = reply_to_all_of(scanner, head_of_upload((160U << 20U) + 1));
  EXPECT_EQ(large.status, 413);
  EXPECT_EQ(parsed(large)["code"], "too-large");
  const Reply chunks = reply_to(
      scanner.port(), std::string("PUT ") + update_path + " HTTP/1.1\r\nHost: localhost\r\n" +
                          "Content-Type: application/octet-stream\r\n"
                          "Transfer-Encoding: chunked\r\n\r\n3\r\nabc\r\n0\r\n\r\n");
  EXPECT_EQ(chunks.status, 411);
  EXPECT_TRUE(fs::is_empty(requests()));
}

TEST_F(Appliances, SayThatThereIsNoRoomForAnUpdate) {
  const Daemon scanner = daemon({.file_bytes = 2'000'000});
  const Reply reply = upload(scanner, std::string(5'000'000, 'x'));
  EXPECT_EQ(reply.status, 507);
  EXPECT_EQ(parsed(reply)["code"], "no-space");
  EXPECT_TRUE(fs::is_empty(requests()));
  EXPECT_EQ(parsed(scanner.get(update_path))["state"], "none");
}

TEST_F(Appliances, TakeUpdatesFromTheirOwnPageAlone) {
  const Daemon scanner = daemon();
  EXPECT_EQ(upload(scanner, "x", "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(request(scanner.port(), "PUT", update_path, "{}").status, 415);
  const std::string rebound = std::string("PUT ") + update_path +
                              " HTTP/1.1\r\nHost: evil.example\r\nContent-Length: 1\r\n"
                              "Content-Type: application/octet-stream\r\n\r\nx";
  EXPECT_EQ(reply_to(scanner.port(), rebound).status, 421);
  const std::string elsewhere =
      "POST /api/v1/scans HTTP/1.1\r\nHost: localhost\r\nContent-Length: 2\r\n"
      "Content-Type: application/octet-stream\r\n\r\n{}";
  EXPECT_EQ(reply_to(scanner.port(), elsewhere).status, 415);
  EXPECT_TRUE(fs::is_empty(requests()));
  EXPECT_EQ(request(scanner.port(), "DELETE", update_path).header("Allow"), "GET, HEAD, PUT");
}

TEST_F(Appliances, TellOfTheWifiAndAskForAnother) {
  const Daemon scanner = daemon();
  answer("wifi", "state = hotspot\ncountry = DE\nhotspot = Octurn-1A2B\nerror = Home is away.\n");
  answer("networks",
         "bssid / frequency / signal level / flags / ssid\n"
         "02:00:00:00:00:01\t2412\t-70\t[ESS]\tGuests\n"
         "02:00:00:00:00:02\t2412\t-50\t[WPA2-PSK-CCMP][ESS]\tCaf\\xc3\\xa9\n");
  const json wifi = parsed(scanner.get(wifi_path));
  EXPECT_EQ(wifi["state"], "hotspot");
  EXPECT_EQ(wifi["name"], "");
  EXPECT_EQ(wifi["country"], "DE");
  EXPECT_EQ(wifi["hotspot"], "Octurn-1A2B");
  EXPECT_EQ(wifi["error"], "Home is away.");
  EXPECT_FALSE(wifi["host"].get<std::string>().empty());
  EXPECT_EQ(wifi["networks"], json::parse(R"([{"name": "Café", "signal_dbm": -50, "secured": true},
                            {"name": "Guests", "signal_dbm": -70, "secured": false}])"));

  const Reply reply = request(scanner.port(), "PUT", wifi_path,
                              R"({"name": "Café", "password": "open sesame", "country": "de"})");
  EXPECT_EQ(reply.status, 202);
  EXPECT_EQ(parsed(reply)["state"], "joining");
  EXPECT_EQ(reply.body.find("sesame"), std::string::npos);
  EXPECT_EQ(content_of(requests() / "wifi"),
            "wifi_name = Café\nwifi_password = open sesame\nwifi_country = DE\n");
}

TEST_F(Appliances, ChangeNothingForAWifiThatIsWrong) {
  const Daemon scanner = daemon();
  for (const char* const body :
       {"{}", "[]", "{", R"({"name": "a\nwifi_country = US", "country": "DE"})",
        R"({"name": "Home", "password": "short", "country": "DE"})",
        R"({"name": "Home", "country": "Germany"})", R"({"name": "\ud800", "country": "DE"})"}) {
    const Reply reply = request(scanner.port(), "PUT", wifi_path, body);
    EXPECT_EQ(reply.status, 400) << body;
    EXPECT_EQ(reply.body.find("short"), std::string::npos);
  }
  EXPECT_TRUE(fs::is_empty(requests()));
}

TEST_F(Appliances, PutTheirErrorsAndNoPasswordIntoTheDiagnostics) {
  const Daemon scanner = daemon();
  answer("errors", "2026-11-21 octurn: <3>no supply\n");
  request(scanner.port(), "PUT", wifi_path,
          R"({"name": "Home", "password": "open sesame", "country": "DE"})");
  const std::vector<ArchivedFile> files = unzipped(scanner.get("/api/v1/diagnostics.zip").body);
  EXPECT_EQ(content_in(files, "errors.txt"), "2026-11-21 octurn: <3>no supply\n");
  for (const ArchivedFile& file : files) {
    EXPECT_EQ(file.content.find("sesame"), std::string::npos) << file.name;
    EXPECT_EQ(file.content.find("Home\""), std::string::npos) << file.name;
  }
}

TEST(Serve, KnowsNoUpdatesOrWifiUnlessItIsAnAppliance) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  EXPECT_EQ(daemon.status()["appliance"], false);
  for (const Reply& reply :
       {daemon.get(update_path), daemon.get(wifi_path), upload(daemon, "bundle"),
        request(daemon.port(), "PUT", wifi_path, R"({"name": "Home", "country": "DE"})")}) {
    EXPECT_EQ(reply.status, 404);
    EXPECT_EQ(parsed(reply)["code"], "not-an-appliance");
    EXPECT_FALSE(parsed(reply)["hint"].get<std::string>().empty());
  }
}

TEST(UpdateCommand, IsForTheAppliance) {
  if (fs::exists("/usr/lib/octurn/update")) {
    GTEST_SKIP() << "this machine is one";
  }
  Program program({octurn_program(), "update", "octurn.update"});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_EQ(std::ranges::count(program.errors(), '\n'), 1) << program.errors();
  EXPECT_NE(program.errors().find("apt install"), std::string::npos) << program.errors();
  Program without({octurn_program(), "update"});
  EXPECT_EQ(without.wait(), 2);
  Program help({octurn_program(), "update", "--help"});
  EXPECT_EQ(help.wait(), 0);
}

}  // namespace
}  // namespace octurn
