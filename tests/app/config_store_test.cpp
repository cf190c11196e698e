#include "config/config_store.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <vector>

#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// Stores that are opened one after the other on the same data folder.
class ConfigStores : public ::testing::Test {
 protected:
  ConfigStore open(const json& given = json::object()) const {
    ConfigLayers layers{.given = given};
    layers.file.data = folder_.path();
    layers.file.turntable.gear_ratio = 4;  // from octurn.json
    return ConfigStore(std::move(layers));
  }
  std::filesystem::path file(const char* name) const { return folder_.path() / name; }

 private:
  TemporaryFolder folder_;
};

TEST_F(ConfigStores, KeepWhatThePageSets) {
  open().change({{"turntable", {{"full_steps", 400}}}, {"scan", {{"snapshots", 12}}}});
  const ConfigStore next = open();
  EXPECT_EQ(next.config().turntable.full_steps, 400);
  EXPECT_EQ(next.config().turntable.gear_ratio, 4);
  EXPECT_EQ(next.config().scan.snapshots, 12);
  EXPECT_EQ(next.trouble(), "");
}

TEST_F(ConfigStores, KeepHowACameraExposesAndAskForARestart) {
  ConfigStore store = open();
  store.change({{"laser", {{"exposure_ms", 25}, {"gain", 2}}}});
  EXPECT_EQ(store.restart_needed(), (std::vector<std::string>{"laser.exposure_ms", "laser.gain"}));
  EXPECT_EQ(open().config().laser.exposure, std::chrono::milliseconds(25));
  EXPECT_EQ(open().config().laser.gain, 2);
}

TEST_F(ConfigStores, GoBackToOcturnJsonWhereAKeyBecomesNull) {
  open().change({{"turntable", {{"gear_ratio", 2}, {"full_steps", 400}}}});
  open().change({{"turntable", {{"gear_ratio", nullptr}}}});
  EXPECT_EQ(open().config().turntable.gear_ratio, 4);
  EXPECT_EQ(open().config().turntable.full_steps, 400);
  open().change({{"turntable", {{"full_steps", nullptr}}}});
  EXPECT_EQ(open().stored(), json::object());
}

TEST_F(ConfigStores, AreOverruledByTheCommandLine) {
  open().change({{"port", 8123}});
  EXPECT_EQ(open().config().http.port, 8123);
  EXPECT_EQ(open({{"port", 8124}}).config().http.port, 8124);
}

TEST_F(ConfigStores, RefuseWhatIsWrongByItsKeyAndChangeNothing) {
  open().change({{"port", 8123}});
  const std::vector<std::pair<const char*, json>> wrong{
      {"port", {{"port", 70000}}},
      {"ports", {{"ports", 80}}},
      {"data", {{"data", "/tmp"}}},
      {"password_file", {{"password_file", ""}}},
      {"turntable.gear_ratio", {{"turntable", {{"gear_ratio", 0}}}}},
      {"turntable.gear", {{"turntable", {{"gear", 1}}}}},
      {"turntable.take_up_steps", {{"turntable", {{"take_up_steps", 3201}}}}},
      {"scan.leaf_size_mm", {{"scan", {{"leaf_size_mm", 2000}}}}},
      {"scan.clip_mm", {{"scan", {{"clip_mm", {0, 0, 0, 0.5, 100, 100}}}}}},
      {"sensor", {{"sensor", "laser-line"}}},
      {"laser.width", {{"laser", {{"width", 640}}}}},
      {"laser.left", {{"laser", {{"left", {{"line", "GPIO21"}}}}}}},
      {"laser.exposure_ms", {{"laser", {{"exposure_ms", 0}}}}},
      {"scan", {{"scan", 5}}}};
  for (const auto& [key, change] : wrong) {
    ConfigStore store = open();
    const Error error = error_thrown_by([&, change = change] { store.change(change); });
    EXPECT_EQ(error.code(), ErrorCode::bad_settings) << error.what();
    EXPECT_EQ(std::string(error.what()).find("\"" + std::string(key) + "\""), 0U) << error.what();
    EXPECT_EQ(store.stored(), json({{"port", 8123}}));
    EXPECT_EQ(open().config().http.port, 8123);
  }
  for (const json& change : {json(nullptr), json(5), json::array()}) {
    ConfigStore store = open();
    EXPECT_EQ(code_thrown_by([&] { store.change(change); }), "bad-settings");
  }
}

TEST_F(ConfigStores, RefuseTheTurntableALineOfALaser) {
  ConfigLayers layers;
  layers.file.data = file("");
  layers.file.sensor = SensorKind::laser_line;
  const json change{{"turntable", {{"step_line", layers.file.laser.left.gpio_line}}}};
  ConfigStore store(layers);
  const Error error = error_thrown_by([&] { store.change(change); });
  EXPECT_EQ(error.code(), ErrorCode::bad_settings);
  EXPECT_NE(std::string(error.what()).find("GPIO23"), std::string::npos) << error.what();
  EXPECT_EQ(store.stored(), json::object());
  open().change(change);  // without lasers that line is free
}

TEST_F(ConfigStores, PutAScansSettingsInForceAtOnceAndTellOfTheRest) {
  ConfigStore store = open();
  store.change({{"scan", {{"snapshots", 12}}},
                {"host_names", {"scanner.example"}},
                {"keep_sensor_on", true},
                {"threads", 3},
                {"turntable", {{"gear_ratio", 2}}}});
  EXPECT_EQ(store.config().scan.snapshots, 12);
  EXPECT_EQ(store.config().host_names, std::vector<std::string>{"scanner.example"});
  EXPECT_EQ(store.config().turntable.gear_ratio, 4);
  EXPECT_EQ(store.restart_needed(),
            (std::vector<std::string>{"keep_sensor_on", "threads", "turntable.gear_ratio"}));
  EXPECT_TRUE(open().config().keep_sensor_on);
  EXPECT_EQ(open().restart_needed(), std::vector<std::string>{});
}

TEST_F(ConfigStores, NeedNoRestartForAPasswordOfThePage) {
  const ConfigStore store = open();
  EXPECT_EQ(store.config().http.own_password_file, file("page-password"));
  put(file("page-password"), "octurn:Octurn:0123\n");
  EXPECT_EQ(store.restart_needed(), std::vector<std::string>{});
}

TEST_F(ConfigStores, UseTheLastGoodSettingsWhereTheFileIsDamaged) {
  ConfigStore store = open();
  store.change({{"scan", {{"snapshots", 12}}}});
  store.keep_as_good();
  const std::string whole = content_of(file("settings.json"));
  for (std::size_t length = 0; length + 1 < whole.size(); ++length) {
    put(file("settings.json"), whole.substr(0, length));
    const ConfigStore next = open();
    EXPECT_EQ(next.config().scan.snapshots, 12) << length;
    EXPECT_NE(next.trouble().find("settings.json"), std::string::npos) << length;
  }
}

TEST_F(ConfigStores, StartWithNothingWhereNoFileIsGood) {
  put(file("settings.json"), "[]");
  put(file("settings.last.json"), std::string(3, '\0'));
  const ConfigStore store = open();
  EXPECT_EQ(store.stored(), json::object());
  EXPECT_NE(store.trouble(), "");
}

TEST_F(ConfigStores, LeaveOutOnlyWhatALaterVersionHasAdded) {
  put(file("settings.json"),
      R"({"shine": 1, "threads": 3, "scan": {"snapshots": 12, "glow": true}})");
  const ConfigStore store = open();
  EXPECT_EQ(store.stored(), json::parse(R"({"threads": 3, "scan": {"snapshots": 12}})"));
  EXPECT_NE(store.trouble().find("unknown key"), std::string::npos) << store.trouble();
}

TEST_F(ConfigStores, ForgetTheTroubleWithTheNextChange) {
  put(file("settings.json"), "{");
  ConfigStore store = open();
  ASSERT_NE(store.trouble(), "");
  store.change({{"threads", 3}});
  EXPECT_EQ(store.trouble(), "");
  EXPECT_EQ(open().trouble(), "");
}

TEST_F(ConfigStores, ReturnToTheLastGoodSettingsOnce) {
  ConfigStore store = open();
  store.change({{"threads", 3}});
  store.keep_as_good();
  store.change({{"port", 1}});
  EXPECT_TRUE(store.return_to_last_good());
  EXPECT_EQ(open().stored(), json({{"threads", 3}}));
  EXPECT_FALSE(store.return_to_last_good());
}

/// Things in place of a file that can be neither read nor replaced.
const std::vector<std::function<void(const fs::path& file)>> obstacles{
    [](const fs::path& file) { fs::create_directory(file); },
    [](const fs::path& file) { ASSERT_EQ(::mkfifo(file.c_str(), 0644), 0); },
    [](const fs::path& file) { fs::create_symlink("/dev/full", file); }};

TEST_F(ConfigStores, ServeAlsoIfTheLastGoodSettingsCannotBeKept) {
  for (const auto& obstacle : obstacles) {
    ConfigStore store = open();
    store.change({{"threads", 3}});
    fs::remove_all(file("settings.last.json"));
    obstacle(file("settings.last.json"));
    EXPECT_NO_THROW(store.keep_as_good());
    EXPECT_EQ(open().stored(), json({{"threads", 3}}));
  }
}

TEST_F(ConfigStores, ReturnToTheLastGoodSettingsAlsoIfTheseCannotBeStored) {
  for (const auto& obstacle : obstacles) {
    fs::remove_all(file("settings.json"));
    ConfigStore store = open();
    store.change({{"threads", 3}});
    store.keep_as_good();
    store.change({{"threads", 4}});
    fs::remove(file("settings.json"));
    obstacle(file("settings.json"));
    EXPECT_TRUE(store.return_to_last_good());
    EXPECT_EQ(store.stored(), json({{"threads", 3}}));
    EXPECT_EQ(store.config().limits.threads, 3);
  }
}

TEST(ConfigSchema, TellsWhatIsAllowedAndWhatWaitsForARestart) {
  const json keys = config_schema()["properties"];
  EXPECT_EQ(keys["turntable"]["properties"]["gear_ratio"]["maximum"], 1000);
  EXPECT_EQ(keys["turntable"]["x-restart"], true);
  EXPECT_EQ(keys["scan"]["x-restart"], false);
  EXPECT_FALSE(keys.contains("sensor"));
  const json& of_laser = keys["laser"]["properties"];
  EXPECT_EQ(of_laser.size(), 2U);
  EXPECT_EQ(of_laser["exposure_ms"]["maximum"], 1000);
  EXPECT_EQ(of_laser["gain"]["maximum"], 64);
  EXPECT_EQ(keys["laser"]["x-restart"], true);
}

}  // namespace
}  // namespace octurn
