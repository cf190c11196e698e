// `octurn calibrate` and `octurn reconstruct --calibrate`, end to end.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/calibrate/rendered_turn.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class CalibrateCommand : public ::testing::Test {
 protected:
  /// Stores a rendered turn as a scan. @param told  its configured pose, which may be wrong
  void write_turn(const CalibrationTurn& turn, const Eigen::Isometry3d& told) const {
    Scan scan{.sensor_name = "test",
              .intrinsics = turn.intrinsics,
              .platform_from_sensor = told,
              .clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}}};
    for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
      scan.shots.push_back({.file = shot_file(static_cast<int>(stop)), .angle = turn.angles[stop]});
      write_depth_png(scan_ / scan.shots.back().file, turn.read(stop));
    }
    write_scan(scan_, scan);
  }

  /// The output of `octurn calibrate --json`; fails unless it ends with that status.
  json report(int status, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{octurn_program(), "calibrate", scan_.string(), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    Program program(words);
    EXPECT_EQ(program.wait(), status) << program.errors();
    EXPECT_EQ(std::ranges::count(program.output(), '\n'), 1);
    return json::parse(program.output());
  }

  /// The model of `octurn reconstruct --calibrate SOURCE`; without that option if `source` is
  /// empty.
  std::string model(const std::string& source = "") const {
    const fs::path output = folder_.path() / "Scan.stl";
    std::vector<std::string> words{
        octurn_program(), "reconstruct", scan_.string(),   "-o", output.string(),
        "--method",       "solid",       "--leaf-size-mm", "4"};
    if (!source.empty()) {
      words.insert(words.end(), {"--calibrate", source});
    }
    Program program(words);
    EXPECT_EQ(program.wait(), 0) << program.errors();
    return content_of(output);
  }

  TemporaryFolder folder_;
  fs::path scan_ = folder_.path() / "scan";
};

const Eigen::Isometry3d told_wrong = wrong_pose({0.006, -0.008, 0.004}, {1, 0.5, 0}, 1.5);

Eigen::Isometry3d pose_from(const json& rows) {
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      matrix(row, column) =
          rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)].get<double>();
    }
  }
  return Eigen::Isometry3d(matrix);
}

TEST_F(CalibrateCommand, SolvesAWrongPoseAndModelsUseIt) {
  write_turn(rendered_turn(figure(), 8), told_wrong);
  const std::string before = content_of(scan_ / "scan.json");

  const json solved = report(0);
  EXPECT_EQ(content_of(scan_ / "scan.json"), before);
  EXPECT_EQ(solved["accepted"], true);
  EXPECT_EQ(solved["reason"], "");
  EXPECT_EQ(solved["findings"], json::array());
  ASSERT_EQ(solved["stops"].size(), 8U);
  EXPECT_EQ(solved["stops"][0]["off_deg"], 0.0);
  EXPECT_NEAR(solved["stops"][2]["angle_deg"].get<double>(), 90, 1e-9);
  const AxisError error = axis_error(pose_from(solved["platform_from_sensor"]));
  EXPECT_LT(error.position_mm, 0.12);  // required of a Kinect with eight stops
  EXPECT_LT(error.direction_deg, 0.05);
  EXPECT_NEAR(solved["tilt_deg"].get<double>(), 1.5, 0.05);
  EXPECT_LT(solved["after_mm"].get<double>(), solved["before_mm"].get<double>());

  const std::string by_itself = model();
  EXPECT_NE(by_itself, model("told"));
  report(0, {"--apply"});
  const json stored = json::parse(content_of(scan_ / "scan.json"))["calibration"];
  EXPECT_EQ(stored["solved"]["platform_from_sensor"], solved["platform_from_sensor"]);
  EXPECT_EQ(stored["solved"]["sigma_mm"], solved["sigma_mm"]);
  EXPECT_EQ(stored["platform_from_sensor"],
            json::parse(before)["calibration"]["platform_from_sensor"]);
  EXPECT_EQ(model("auto"), by_itself);
}

TEST_F(CalibrateCommand, LeavesTheModelOfARightRigAsItIs) {
  write_turn(rendered_turn(figure(), 8), true_platform_from_sensor());
  EXPECT_EQ(report(0)["accepted"], true);
  EXPECT_EQ(model("auto"), model("told"));
}

TEST_F(CalibrateCommand, NamesTheStopOfASlipAndItsSize) {
  std::vector<double> offsets(12, 0.0);
  std::fill(offsets.begin() + 5, offsets.end(), radians_from_degrees(1.8));
  write_turn(rendered_turn(figure(), 12, offsets), true_platform_from_sensor());
  const json findings = report(0)["findings"];
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0]["code"], "slip");
  EXPECT_EQ(findings[0]["stop"], 5);
  EXPECT_NEAR(findings[0]["deg"].get<double>(), 1.8, 0.3);
}

TEST_F(CalibrateCommand, RefusesAnEmptyPlatformWithExit1) {
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  write_turn(rendered_turn(nothing, 4), true_platform_from_sensor());
  const std::string before = content_of(scan_ / "scan.json");
  const json refused = report(1, {"--apply"});
  EXPECT_EQ(refused["accepted"], false);
  EXPECT_NE(refused["reason"], "");
  EXPECT_TRUE(refused["platform_from_sensor"].is_null());
  EXPECT_EQ(content_of(scan_ / "scan.json"), before);
}

}  // namespace
}  // namespace octurn
