#include <gtest/gtest.h>

#include "app/response_header.hpp"
#include "http/http_server.hpp"
#include "http/same_origin.hpp"
#include "support/http_client.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

class CaptivePortal : public ::testing::Test {
 protected:
  CaptivePortal() { std::filesystem::create_directory(folder_.path() / "requests"); }

  void set_wifi(const std::string& state) const {
    put(folder_.path() / "wifi", "state = " + state + "\n");
  }

  std::optional<Response> ask(const std::string& host, const std::string& path,
                              const std::string& method = "GET") const {
    return captive_answer({.method = method, .path = path, .headers = {{"Host", host}}}, {},
                          appliance_);
  }

  TemporaryFolder folder_ = {};
  Appliance appliance_{folder_.path()};
};

TEST_F(CaptivePortal, SendsPhonesThatLookForTheInternetToThePage) {
  set_wifi("hotspot");
  for (const auto& [host, path] : std::vector<std::pair<std::string, std::string>>{
           {"connectivitycheck.gstatic.com", "/generate_204"},
           {"captive.apple.com", "/hotspot-detect.html"},
           {"www.msftconnecttest.com", "/connecttest.txt"},
           {"www.msftncsi.com", "/ncsi.txt"},
           {"detectportal.firefox.com", "/success.txt"}}) {
    const auto answer = ask(host, path);
    ASSERT_TRUE(answer) << host;
    EXPECT_EQ(answer->status, 302);
    EXPECT_EQ(header(*answer, "Location"), "http://192.168.77.1/");
    EXPECT_EQ(header(*answer, "Cache-Control"), "no-store");
  }
}

TEST_F(CaptivePortal, LeavesThePageItself) {
  set_wifi("hotspot");
  EXPECT_FALSE(ask("192.168.77.1", "/"));
  EXPECT_FALSE(ask("octurn.local", "/generate_204"));
}

TEST_F(CaptivePortal, ChangesNothingByIt) {
  set_wifi("hotspot");
  EXPECT_FALSE(ask("evil.example", "/api/v1/scans", "POST"));
}

TEST_F(CaptivePortal, IsInTheScannersOwnWifiAlone) {
  for (const char* state : {"none", "joining", "joined", "failed"}) {
    set_wifi(state);
    EXPECT_FALSE(ask("captive.apple.com", "/hotspot-detect.html")) << state;
  }
}

TEST(HttpServer, AsksItsGateFirst) {
  const HttpServer server(
      {.address = "127.0.0.1", .port = 0}, [](const Request&) { return Response{.body = "page"}; },
      nullptr,
      [](const Request& request) {
        return request.path == "/gate" ? std::optional(Response{.status = 302}) : std::nullopt;
      });
  EXPECT_EQ(request(server.port(), "GET", "/gate").status, 302);
  EXPECT_EQ(request(server.port(), "GET", "/").body, "page");
}

}  // namespace
}  // namespace octurn
