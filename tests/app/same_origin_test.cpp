#include "http/same_origin.hpp"

#include <gtest/gtest.h>

namespace octurn {
namespace {

const std::vector<std::string> ours{"scanner.example"};

std::string code(const Request& request) {
  const auto refused = refusal(request, ours);
  return refused ? std::string(to_string(refused->code)) : "";
}

Request get(const char* host) { return {.headers = {{"Host", host}}}; }

Request post(Headers headers) {
  Request request{.method = "POST", .headers = {{"Host", "octurn.local:8080"}}};
  request.headers.insert(request.headers.end(), headers.begin(), headers.end());
  return request;
}

TEST(SameOrigin, AnswersUnderNamesThatNobodyElseCanOwn) {
  for (const char* const host :
       {"localhost", "localhost:8080", "127.0.0.1:8080", "192.168.1.5", "[::1]:8080", "[fe80::1]",
        "octurn", "octurn.local", "OCTURN.LOCAL:80", "octurn.lan", "scanner.example",
        "octurn.home.arpa", "octurn.local.", "octurn.local.:8080"}) {
    EXPECT_EQ(code(get(host)), "") << host;
  }
}

TEST(SameOrigin, RefusesNamesThatAnotherSiteMayPointHere) {
  for (const char* const host :
       {"evil.example", "127.0.0.1.evil.example", "octurn.local.evil.example", "xscanner.example",
        "evillocal.example:8080", "", ":8080", ".local", "1.2.3.4.5", "[evil.example]",
        "[::1]evil.example", "[::1", "1.2.3.4:evil.example", "a@b"}) {
    EXPECT_EQ(code(get(host)), "wrong-host") << host;
  }
  EXPECT_EQ(code({}), "wrong-host");
}

TEST(SameOrigin, LetsNoOtherSiteReadTheApiWhereTheBrowserSaysSo) {
  const auto from = [](const char* site, const char* path) {
    return code(Request{.path = path, .headers = {{"Host", "octurn"}, {"Sec-Fetch-Site", site}}});
  };
  EXPECT_EQ(from("cross-site", "/api/v1/scans/x/scan.zip"), "wrong-origin");
  EXPECT_EQ(from("cross-site", "/"), "") << "a link to the page";
  EXPECT_EQ(from("same-origin", "/api/v1/status"), "");
  EXPECT_EQ(from("none", "/api/v1/status"), "") << "typed in";
}

TEST(SameOrigin, LetsItsOwnPageChangeThings) {
  const std::pair<std::string, std::string> json{"Content-Type", "application/json"};
  EXPECT_EQ(code(post({json})), "");
  EXPECT_EQ(code(post({json, {"Origin", "http://octurn.local:8080"}})), "");
  EXPECT_EQ(code(post({{"content-type", "Application/JSON; charset=utf-8"}})), "");
}

TEST(SameOrigin, BelievesWhatATrustedProxyForwardsAndNobodyElse) {
  const std::vector<std::string> proxies{"10.0.0.2"};
  const auto taken = [&](std::string address, const Headers& headers) {
    Request request = post(headers);
    take_forwarded(request, address, proxies);
    return std::string(*request.header("Host")) + " " + address;
  };
  const Headers headers{{"X-Forwarded-Host", "evil.example, scanner.example"},
                        {"X-Forwarded-For", "1.2.3.4, 10.0.0.9"}};
  EXPECT_EQ(taken("10.0.0.2", headers), "scanner.example 10.0.0.9");
  EXPECT_EQ(taken("::ffff:10.0.0.2", headers), "scanner.example 10.0.0.9");
  EXPECT_EQ(taken("10.0.0.3", headers), "octurn.local:8080 10.0.0.3");
  EXPECT_EQ(taken("10.0.0.2", {}), "octurn.local:8080 10.0.0.2");
  // Two proxies: the client is before the first of them. What is no address counts for nothing.
  EXPECT_EQ(taken("10.0.0.2", {{"X-Forwarded-For", "1.2.3.4,fd00::7 , 10.0.0.2"}}),
            "octurn.local:8080 fd00::7");
  EXPECT_EQ(taken("10.0.0.2", {{"X-Forwarded-For", "1.2.3.4, unknown"}}),
            "octurn.local:8080 10.0.0.2");
  EXPECT_EQ(taken("10.0.0.2", {{"X-Forwarded-For", "1.2.3.4"}, {"X-Forwarded-For", "10.0.0.9"}}),
            "octurn.local:8080 10.0.0.9");
}

TEST(SameOrigin, NamesTheSettingOfAProxyThatItDoesNotBelieve) {
  const auto refused = refusal(post({{"Content-Type", "application/json"},
                                     {"Origin", "https://scanner.example"},
                                     {"X-Forwarded-Host", "scanner.example"}}),
                               ours);
  ASSERT_TRUE(refused);
  EXPECT_NE(refused->hint.find("trusted_proxies"), std::string::npos) << refused->hint;
}

TEST(SameOrigin, RefusesOtherPages) {
  for (const char* const origin :
       {"http://evil.example", "http://octurn.local", "http://octurn.local:80801", "null", "",
        "octurn.local:8080", "http://octurn.local:8080.evil.example"}) {
    EXPECT_EQ(code(post({{"Content-Type", "application/json"}, {"Origin", origin}})),
              "wrong-origin")
        << origin;
  }
}

TEST(SameOrigin, SaysWhatAProxyHasChanged) {
  const auto refused = refusal(
      post({{"Content-Type", "application/json"}, {"Origin", "https://scanner.example"}}), ours);
  EXPECT_EQ(refused->detail,
            "the request comes from https://scanner.example, and is for octurn.local:8080");
  EXPECT_NE(refused->hint.find("Host"), std::string::npos);
}

TEST(SameOrigin, RefusesWhatAFormCanSend) {
  for (const char* const type : {"text/plain", "application/x-www-form-urlencoded",
                                 "multipart/form-data", "", "application/jsonp"}) {
    EXPECT_EQ(code(post({{"Content-Type", type}})), "wrong-content-type") << type;
  }
  EXPECT_EQ(code(post({{"Content-Length", "2"}})), "wrong-content-type");
  EXPECT_EQ(code(post({{"Transfer-Encoding", "chunked"}})), "wrong-content-type");
}

TEST(SameOrigin, TakesWhatHasNoBodyWithoutAType) {
  EXPECT_EQ(code(post({})), "");
  EXPECT_EQ(code(post({{"Content-Length", "0"}})), "");
  EXPECT_EQ(code(post({{"Origin", "http://evil.example"}})), "wrong-origin");
}

TEST(SameOrigin, TakesAnUploadWhereOneIsExpected) {
  const Request upload = post({{"Content-Type", "application/octet-stream"}});
  EXPECT_EQ(code(upload), "wrong-content-type");
  EXPECT_EQ(refusal(upload, ours, upload_type), std::nullopt);
  Request scan = post({{"Content-Type", "application/zip"}});
  EXPECT_NE(refusal(scan, ours, upload_type), std::nullopt) << "an update is no archive";
  scan.path = import_path;
  EXPECT_EQ(refusal(scan, ours, upload_type), std::nullopt);
  scan = post({});
  scan.path = import_path;
  EXPECT_EQ(refusal(scan, ours, upload_type), std::nullopt);
  scan = post({{"Origin", "http://evil.example"}});
  scan.path = import_path;
  EXPECT_NE(refusal(scan, ours, upload_type), std::nullopt);
  EXPECT_NE(refusal(post({{"Content-Type", "application/json"}}), ours, upload_type), std::nullopt);
}

TEST(SameOrigin, LetsADeleteGoWithoutAType) {
  Request request = post({});
  request.method = "DELETE";
  EXPECT_EQ(code(request), "");
  request.headers.emplace_back("Origin", "http://evil.example");
  EXPECT_EQ(code(request), "wrong-origin");
}

TEST(SameOrigin, LetsAnyPageLink) {
  Request request = get("octurn.local");
  request.headers.emplace_back("Origin", "http://evil.example");
  EXPECT_EQ(code(request), "");  // the browser hides the response, and GET changes nothing
}

}  // namespace
}  // namespace octurn
