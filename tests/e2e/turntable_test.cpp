// The turntable, moved and tested over HTTP, with a gear and wiring that differ from the settings.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/daemon.hpp"

namespace octurn {
namespace {

using nlohmann::json;

const std::string turntable_path = "/api/v1/turntable";

json wait_until_idle(const Daemon& daemon) {
  return daemon.wait_until(turntable_path, [](const json& now) { return now["state"] == "idle"; });
}

json finding(const json& now, const std::string& check) {
  for (const json& one : now["test"]["findings"]) {
    if (one["check"] == check) {
      return one;
    }
  }
  ADD_FAILURE() << "no finding " << check << " in " << now;
  return {};
}

TEST(Turntable, TestTellsTheSettingsThatCureIt) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--simulate-gear", "1.5", "--simulate-reversed"});
  ASSERT_EQ(daemon.post(turntable_path, R"({"test": true})").status, 202);
  const json tested = wait_until_idle(daemon);
  ASSERT_EQ(tested["test"]["state"], "done") << tested;
  EXPECT_EQ(finding(tested, "turn-direction")["set"], json({{"reversed", true}}));
  EXPECT_NEAR(finding(tested, "turn-whole")["set"].value("gear_ratio", 0.0), 1.5, 0.006);

  const json cure{{"turntable", {{"gear_ratio", 1.5}, {"reversed", true}}}};
  ASSERT_EQ(request(daemon.port(), "PATCH", "/api/v1/settings", cure.dump()).status, 200);
}

TEST(Turntable, TestFindsNothingWrongOnceItIsCured) {
  const TemporaryFolder folder;
  put(folder.path() / "octurn.json", R"({"turntable": {"gear_ratio": 1.5, "reversed": true}})");
  const Daemon daemon(folder.path(), {"--simulate-gear", "1.5", "--simulate-reversed", "--config",
                                      folder.path() / "octurn.json"});
  ASSERT_EQ(daemon.post(turntable_path, R"({"test": true})").status, 202);
  const json tested = wait_until_idle(daemon);
  for (const json& one : tested["test"]["findings"]) {
    EXPECT_EQ(one["state"], "ok") << one;
  }
  EXPECT_EQ(tested["test"]["findings"].size(), 6U);
}

TEST(Turntable, Jogs) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  ASSERT_EQ(daemon.post(turntable_path, R"({"jog_deg": 10})").status, 202);
  const json now = wait_until_idle(daemon);
  EXPECT_EQ(now["error"], nullptr);
  EXPECT_EQ(now["test"], nullptr);
  EXPECT_NE(content_of(folder.path() / "data" / "platform.json").find("9.9"), std::string::npos)
      << "22 of 800 steps";
}

TEST(Turntable, StopsATest) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), {"--simulate-speed", "0.1"});  // the test takes minutes
  ASSERT_EQ(daemon.post(turntable_path, R"({"test": true})").status, 202);
  EXPECT_EQ(daemon.post(turntable_path, R"({"test": true})").status, 409);
  ASSERT_EQ(daemon.post(turntable_path, R"({"stop": true})").status, 202);
  EXPECT_EQ(wait_until_idle(daemon)["test"]["state"], "cancelled");
}

TEST(Turntable, IsTheScansWhileOneRuns) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  EXPECT_EQ(daemon.post(turntable_path, R"({"jog_deg": 10})").status, 409);
  daemon.post(scan + "/cancel");
  daemon.wait_until_done(scan);
}

TEST(Turntable, RefusesWhatIsNoMove) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  for (const char* const body :
       {"{}", R"({"jog_deg": 361})", R"({"jog_deg": "10"})", R"({"test": false})", R"({"spin": 1})",
        R"({"test": true, "stop": true})", "[]"}) {
    EXPECT_EQ(daemon.post(turntable_path, body).status, 400) << body;
  }
}

TEST(DoctorCommand, TurnsThePlatformWhereItIsAsked) {
  const TemporaryFolder folder;
  Program program({octurn_program(), "doctor", "--simulate", "--simulate-speed", "20",
                   "--simulate-gear", "1.5", "--turn", "--json", "--data", folder.path() / "data"});
  EXPECT_EQ(program.wait(), 1);
  const json report = json::parse(program.output());
  const auto turn = std::ranges::find(report["findings"], "turn-whole",
                                      [](const json& one) { return one["check"]; });
  ASSERT_NE(turn, report["findings"].end()) << report;
  EXPECT_EQ((*turn)["state"], "fault");
}

}  // namespace
}  // namespace octurn
