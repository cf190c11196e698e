// `octurn record --wall`, `octurn calibrate --wall` and `--sensor-map`, end to end.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A simulated Kinect that looks at its platform.
constexpr const char* at_platform = "octurn-simulator://?speed=20";

class CalibrateWallCommand : public ::testing::Test {
 protected:
  /// Runs a command; fails unless it ends with that status. @return what it printed
  static std::string run(int status, std::vector<std::string> words) {
    words.insert(words.begin(), octurn_program());
    Program program(words);
    EXPECT_EQ(program.wait(), status) << program.output() << program.errors();
    return status == 2 ? program.errors() : program.output() + program.errors();
  }

  /// Records a wall at a distance (metres).
  fs::path wall_at(const std::string& distance) const {
    const fs::path wall = folder_.path() / ("wall-" + distance);
    run(0, {"record", "--simulate", "--sensor", "octurn-simulator://?speed=20&wall=" + distance,
            "--wall", wall.string(), "--frames", "8"});
    return wall;
  }

  json report(int status, const std::vector<fs::path>& walls) const {
    std::vector<std::string> words{"calibrate", "--wall"};
    words.insert(words.end(), walls.begin(), walls.end());
    words.insert(words.end(), {"-o", map_.string(), "--json"});
    const std::string printed = run(status, words);
    EXPECT_EQ(std::ranges::count(printed, '\n'), 1) << printed;
    return json::parse(printed);
  }

  /// The bytes of a scan's model.
  std::string model(const fs::path& scan, const std::vector<std::string>& more = {}) const {
    const fs::path output = folder_.path() / "Scan.stl";
    std::vector<std::string> words{
        "reconstruct", scan.string(),    "-o", output.string(), "--method",
        "solid",       "--leaf-size-mm", "4",  "--calibrate",   "told"};
    words.insert(words.end(), more.begin(), more.end());
    run(0, words);
    return content_of(output);
  }

  TemporaryFolder folder_;
  fs::path map_ = folder_.path() / "map.png";
};

TEST_F(CalibrateWallCommand, MapsTheSensorFromTwoWalls) {
  const fs::path near = wall_at("0.6");
  EXPECT_EQ(read_wall(near).sensor_serial, "simulated-1");
  EXPECT_EQ(read_wall(near).frames.size(), 8U);

  const json found = report(0, {near, wall_at("0.9")});

  EXPECT_EQ(found["accepted"], true);
  EXPECT_EQ(found["reason"], "");
  EXPECT_EQ(found["serial"], "simulated-1");
  ASSERT_EQ(found["walls"].size(), 2U);
  EXPECT_NEAR(found["walls"][0]["distance_m"].get<double>(), 0.6, 0.003);
  EXPECT_NEAR(found["walls"][1]["distance_m"].get<double>(), 0.9, 0.006);
  EXPECT_LT(found["walls"][0]["slant_deg"].get<double>(), 1);
  EXPECT_GT(found["walls"][0]["coverage"].get<double>(), 0.97);  // all but the last 8 columns
  // The pattern has 0.8 steps; the map does not remove a wall's speckle.
  EXPECT_GT(found["rms_before"].get<double>(), 0.75);
  EXPECT_LT(found["rms_after"].get<double>(), 0.6 * found["rms_before"].get<double>());
  const SensorMap map = read_sensor_map(map_);
  EXPECT_EQ(map.serial, "simulated-1");
  EXPECT_EQ(map.made.size(), 20U) << map.made;
  EXPECT_FALSE(map.far.empty());
}

TEST_F(CalibrateWallCommand, RefusesAPlatformWithExit1) {
  const fs::path wall = folder_.path() / "platform";
  run(0,
      {"record", "--simulate", "--sensor", at_platform, "--wall", wall.string(), "--frames", "2"});
  const json found = report(1, {wall});
  EXPECT_EQ(found["accepted"], false);
  EXPECT_NE(found["reason"], "");
  EXPECT_TRUE(found["rms_before"].is_null());
  EXPECT_FALSE(fs::exists(map_));
}

TEST_F(CalibrateWallCommand, CorrectsAScanWithItsMapAlone) {
  const fs::path data = folder_.path() / "data";
  run(0, {"scan", "--simulate", "--sensor", at_platform, "--simulate-speed", "20", "--snapshots",
          "4", "--frames", "2", "--leaf-size-mm", "4", "-o", (folder_.path() / "a.stl").string(),
          "--data", data.string()});
  const fs::path scan = fs::directory_iterator(data / "scans")->path();
  const std::string first_snapshot = content_of(scan / "snapshots/000.png");
  report(0, {wall_at("0.66")});

  const std::string plain = model(scan);
  const std::string with_map = model(scan, {"--sensor-map", map_.string()});
  EXPECT_NE(with_map, plain);
  fs::copy_file(map_, scan / sensor_map_file);
  EXPECT_EQ(model(scan), with_map);
  EXPECT_EQ(content_of(scan / "snapshots/000.png"), first_snapshot);

  put(scan / sensor_map_file, "no map");
  EXPECT_NE(run(1, {"calibrate", scan.string()}).find("sensor-map.png"), std::string::npos);
}

TEST_F(CalibrateWallCommand, RefusesWallsOfTwoSensors) {
  const fs::path other = folder_.path() / "other";
  run(0, {"record", "--simulate", "--sensor", "octurn-simulator://?seed=2&speed=20&wall=0.66",
          "--wall", other.string(), "--frames", "1"});
  EXPECT_NE(
      run(1, {"calibrate", "--wall", wall_at("0.66").string(), other.string(), "-o", map_.string()})
          .find("another sensor"),
      std::string::npos);
}

TEST_F(CalibrateWallCommand, SaysHowItIsUsed) {
  run(2, {"calibrate", "--apply"});
  run(2, {"calibrate", "--wall", "near"});
  run(2, {"calibrate", "scan", "--wall", "near", "-o", "map.png"});
  run(2, {"calibrate", "scan", "-o", "map.png"});
  run(2, {"record", "--simulate"});
  run(2, {"record", "--simulate", "--wall", "near", "-o", "turn"});
  EXPECT_NE(run(1, {"calibrate", "--wall", (folder_.path() / "none").string(), "-o", map_.string()})
                .find("wall.json"),
            std::string::npos);
}

}  // namespace
}  // namespace octurn
