// Scans by laser line, as users of `octurn reconstruct` and `octurn calibrate` meet them.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/laser/lit_scene.hpp"
#include "support/program.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class LaserCommands : public ::testing::Test {
 protected:
  /// What a command prints with `--json`; fails unless it ends with that status.
  json run(int status, const std::vector<std::string>& words) const {
    std::vector<std::string> all{octurn_program()};
    all.insert(all.end(), words.begin(), words.end());
    all.emplace_back("--json");
    Program program(all);
    EXPECT_EQ(program.wait(), status) << program.errors();
    return json::parse(program.output());
  }

  TemporaryFolder folder_;
  fs::path scan_ = folder_.path() / "scan";
  Scan truth_ =
      write_laser_scan(scan_, {.balls = {{.centre = {0.004, -0.003, 0.022}, .radius = 0.022}}}, 48);
};

TEST_F(LaserCommands, MakeASolidOfHalfAMillimetreByDefault) {
  const fs::path model = folder_.path() / "Scan.stl";

  const json report =
      run(0, {"reconstruct", scan_.string(), "-o", model.string(), "--method", "solid"});

  EXPECT_EQ(report["settings"]["leaf_size_mm"], 0.5);
  EXPECT_EQ(report["watertight"], true);
  EXPECT_EQ(report["parts"], 1);
  EXPECT_NEAR(report["volume_cm3"].get<double>(), 44.6, 44.6 * 0.08);  // 4/3 pi 2.2^3
  EXPECT_TRUE(fs::exists(model));
}

TEST_F(LaserCommands, MakeAShellByTheIntersection) {
  const fs::path model = folder_.path() / "Scan.stl";

  const json report =
      run(0, {"reconstruct", scan_.string(), "-o", model.string(), "--leaf-size-mm", "2"});

  EXPECT_EQ(report["settings"]["method"], "intersection");
  EXPECT_EQ(report["watertight"], true);
  EXPECT_NEAR(report["size_mm"][0].get<double>(), 44, 4.5);  // two leaves wider
}

TEST_F(LaserCommands, SolveAndStoreThePlanes) {
  Scan told = truth_;
  Laser& left = told.laser->lasers[0];
  const Eigen::Vector3d up = truth_.platform_from_sensor.linear().transpose().col(2);
  left.normal = Eigen::AngleAxisd(radians_from_degrees(0.1), up) * left.normal;
  left.distance = left.normal.dot(*left.source);
  write_scan(scan_, told);

  const json report = run(0, {"calibrate", scan_.string(), "--apply"});

  EXPECT_EQ(report["accepted"], true);
  EXPECT_LT(report["after_mm"], report["before_mm"]);
  ASSERT_EQ(report["lasers"].size(), 2U);
  const json stored = json::parse(content_of(scan_ / "scan.json"));
  EXPECT_EQ(stored["calibration"]["solved"]["lasers"], report["lasers"]);
  const Laser solved = read_scan(scan_).solved->lasers[0];
  EXPECT_LT((solved.normal - truth_.laser->lasers[0].normal).norm(), 1e-3);
  EXPECT_EQ(stored["sensor"]["lasers"][0]["plane_m"][3], left.distance);  // stays as told
}

TEST_F(LaserCommands, SayWhatIsMissing) {
  fs::remove(scan_ / "snapshots" / "7-right.png");
  Program program({octurn_program(), "reconstruct", scan_.string(), "-o",
                   (folder_.path() / "Scan.stl").string()});
  EXPECT_EQ(program.wait(), 1);
  EXPECT_NE(program.errors().find("7-right.png"), std::string::npos) << program.errors();
  EXPECT_FALSE(fs::exists(folder_.path() / "Scan.stl"));
}

}  // namespace
}  // namespace octurn
