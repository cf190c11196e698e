#include "config.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Config config_of(const char* text) {
  const TemporaryFolder folder;
  put(folder.path() / "octurn.json", text);
  return read_config(folder.path() / "octurn.json");
}

TEST(Config, ReadsEveryKey) {
  const Config config =
      config_of(R"({"listen": "127.0.0.1", "port": 80, "host_names": ["octurn.example"],
                                      "password_file": "/srv/password",
                                      "data": "/srv/scans", "threads": 2, "memory_limit_mb": 64,
                                      "scan": {"snapshots": 12},
                                      "turntable": {"microsteps": 8}})");
  EXPECT_EQ(config.http.address, "127.0.0.1");
  EXPECT_EQ(config.http.port, 80);
  EXPECT_EQ(config.host_names, std::vector<std::string>{"octurn.example"});
  EXPECT_EQ(config.http.password_file, "/srv/password");
  EXPECT_EQ(config.data, "/srv/scans");
  EXPECT_EQ(config.limits.threads, 2);
  EXPECT_EQ(config.limits.memory_bytes, 64U << 20U);
  EXPECT_EQ(config.scan.snapshots, 12);
  EXPECT_EQ(config.turntable.microsteps, 8);
}

TEST(Config, TakesHalfOfTheMemoryInWholeMegabytes) {
  const double mb = to_json(Config())["memory_limit_mb"].get<double>();
  const double half = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) / 2 *
                      static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1U << 20U);
  EXPECT_EQ(mb, std::floor(mb));
  EXPECT_NEAR(mb, half, 1);
}

TEST(Config, IsWrittenAsItIsRead) {
  const json every = json::parse(R"({
      "listen": "127.0.0.1", "port": 80, "host_names": ["octurn.example"],
      "trusted_proxies": ["10.0.0.2"], "data": "/srv/scans",
      "password_file": "/srv/password", "threads": 2, "memory_limit_mb": 64.5, "scan": {},
      "turntable": {"step_line": "GPIO2", "direction_line": "GPIO3", "enable_line": "GPIO4",
                    "microstep_lines": ["GPIO9", "GPIO10", "GPIO11"], "microsteps": 8,
                    "driver": "DRV8825",
                    "full_steps": 400, "gear_ratio": 2.5, "reversed": true,
                    "speed_deg_per_s": 120.0, "start_speed_deg_per_s": 10.0,
                    "acceleration_deg_per_s2": 80.0, "settle_ms": 20, "idle_release_s": 30,
                    "take_up_steps": 5},
      "sensor": "depth", "keep_sensor_on": true,
      "laser": {"width": 640, "height": 480, "fx": 500.5, "fy": 501.0, "cx": 319.5, "cy": 239.5,
                "k1": -0.05, "k2": 0.25, "exposure_ms": 25, "gain": 2.5,
                "platform_from_sensor": [[1, 0, 0, 0.5], [0, 0, 1, -0.25], [0, -1, 0, 0.125],
                                         [0, 0, 0, 1]],
                "left": {"line": "GPIO12", "plane_m": [1, 0, 0, 0.25], "source_m": [0.25, 0, 0.5]},
                "right": {"line": "", "plane_m": [0, 0, 1, 0.5], "source_m": [0, 1, 0.5]}}})");
  json written = to_json(config_of(every.dump().c_str()));
  EXPECT_EQ(written["scan"], to_json(ScanSettings{}));
  written["scan"] = json::object();
  EXPECT_EQ(written, every);
}

TEST(Config, ReadsAFileOfVersion01AsThatDid) {
  const std::filesystem::path golden = std::filesystem::path(OCTURN_GOLDEN) / "version-0.1";
  json expected = json::parse(content_of(golden / "settings.json"));
  expected["scan"].update(
      {{"calibrate", "auto"}, {"depth_scale", 1.0}, {"parts", "main"}});  // later keys
  expected["sensor"] = "depth";
  expected["keep_sensor_on"] = false;
  expected["trusted_proxies"] = json::array();
  expected["laser"] = to_json(Config())["laser"];
  // Later keys, in degrees: a turn has 400 * 16 * 2.5 steps.
  json& turntable = expected["turntable"];
  for (const auto& [in_steps, in_degrees] : {std::pair("speed_steps_per_s", "speed_deg_per_s"),
                                             {"start_speed_steps_per_s", "start_speed_deg_per_s"},
                                             {"ramp_steps_per_s2", "acceleration_deg_per_s2"}}) {
    turntable[in_degrees] = turntable[in_steps].get<double>() * 360 / 16'000;
    turntable.erase(in_steps);
  }
  turntable["driver"] = "A4988";
  EXPECT_EQ(to_json(read_config(golden / "octurn.json")), expected);
}

TEST(Config, IsTheDefaultWhereTheFileSaysNothing) {
  const Config config = config_of("{}");
  EXPECT_EQ(config.http.port, 8080);
  EXPECT_EQ(config.scan.snapshots, 36);
}

TEST(Config, HasAShorterSettlingTimeForLasersUnlessTheFileHasOne) {
  EXPECT_EQ(config_of("{}").turntable.settle_time.count(), 300);
  EXPECT_EQ(config_of(R"({"sensor": "laser-line", "turntable": {"microsteps": 8}})")
                .turntable.settle_time.count(),
            150);
  EXPECT_EQ(config_of(R"({"sensor": "laser-line", "turntable": {"settle_ms": 300}})")
                .turntable.settle_time.count(),
            300);
}

TEST(Config, NamesTheFileAndTheKeyThatIsWrong) {
  for (const char* const text :
       {R"({"port": 65536})", R"({"port": "80"})", R"({"listen": 1})", R"({"host_names": "a"})",
        R"({"host_names": [1]})", R"({"trusted_proxies": ["proxy.example"]})", R"({"data": false})",
        R"({"data": ""})", R"({"threads": 0})", R"({"memory_limit_mb": 0})", R"({"ports": 80})"}) {
    const Error error = error_thrown_by([&] { config_of(text); });
    EXPECT_EQ(error.code(), ErrorCode::bad_config) << text;
    const std::string key(text + 1, std::string(text).find(':') - 1);
    EXPECT_NE(std::string(error.what()).find("octurn.json: " + key), std::string::npos)
        << error.what();
  }
}

TEST(Config, NamesASettingByWhereItStands) {
  const Error scan = error_thrown_by([] { config_of(R"({"scan": {"frames": 0}})"); });
  EXPECT_NE(std::string(scan.what()).find("\"scan.frames\" is 0"), std::string::npos)
      << scan.what();
  const Error turntable = error_thrown_by([] { config_of(R"({"turntable": {"microsteps": 5}})"); });
  EXPECT_NE(std::string(turntable.what()).find("octurn.json: \"turntable.microsteps\" is 5"),
            std::string::npos)
      << turntable.what();
}

TEST(Config, RefusesWhatIsNoJson) {
  EXPECT_EQ(code_thrown_by([] { config_of("{"); }), "bad-config");
  EXPECT_EQ(code_thrown_by([] { config_of("[]"); }), "bad-config");
  EXPECT_EQ(code_thrown_by([] { config_of(""); }), "bad-config");
}

TEST(Config, NeedNotExistUnlessItIsNamed) {
  const TemporaryFolder folder;
  EXPECT_EQ(code_thrown_by([&] { chosen_config(folder.path() / "none.json"); }), "bad-config");
}

}  // namespace
}  // namespace octurn
