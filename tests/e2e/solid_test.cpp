// `octurn reconstruct` by the method solid, its default, end to end.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "octurn/calibrate.hpp"
#include "support/ball_scan.hpp"
#include "support/program.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

class SolidCommand : public ::testing::Test {
 protected:
  std::vector<std::string> command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{octurn_program(), "reconstruct", scan_.string(), "-o",
                                   output_.string()};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  nlohmann::json report_of(std::vector<std::string> more = {}) const {
    more.emplace_back("--json");
    Program program(command(more));
    EXPECT_EQ(program.wait(), 0) << program.errors();
    return nlohmann::json::parse(program.output());
  }

  void expect_failure(const std::vector<std::string>& more, int status,
                      const std::string& says) const {
    Program program(command(more));
    EXPECT_EQ(program.wait(), status) << program.errors();
    EXPECT_NE(program.errors().find(says), std::string::npos) << program.errors();
    EXPECT_EQ(std::ranges::count(program.errors(), '\n'), 1) << program.errors();
    EXPECT_FALSE(fs::exists(output_));
  }

  /// Replaces the depth images of the scan.
  void redraw(int count, const std::function<std::uint16_t(int u, int v)>& depth) const {
    DepthFrame frame{.width = 640, .height = 480, .depth = {}};
    for (int v = 0; v < 480; ++v) {
      for (int u = 0; u < 640; ++u) {
        frame.depth.push_back(depth(u, v));
      }
    }
    for (int i = 0; i < count; ++i) {
      write_depth_png(scan_ / shot_file(i), frame);
    }
  }

  TemporaryFolder folder_;
  fs::path scan_ = folder_.path() / "scan";
  fs::path output_ = folder_.path() / "Scan.stl";
};

TEST_F(SolidCommand, CallsAModelGoodThatShowsTheWholeObject) {
  write_ball_scan(scan_, 8);
  const auto quality = report_of({"--leaf-size-mm", "2"})["quality"];
  EXPECT_EQ(quality["verdict"], "good");
  EXPECT_EQ(quality["reasons"], nlohmann::json::array());
}

TEST_F(SolidCommand, SaysWhyAModelIsNotGood) {
  write_ball_scan(scan_, 8);
  // The ball's centre is 6 cm up; the box cuts the ball 1 cm above that.
  Program program(command(
      {"--leaf-size-mm", "2", "--clip-mm", "-140", "-140", "2", "140", "140", "70", "--json"}));
  EXPECT_EQ(program.wait(), 0) << program.errors();
  EXPECT_EQ(program.errors().find("Look at the model: "), 0U) << program.errors();
  const auto quality = nlohmann::json::parse(program.output())["quality"];
  EXPECT_EQ(quality["verdict"], "look");
  EXPECT_TRUE(std::ranges::any_of(quality["reasons"], [](const nlohmann::json& reason) {
    return reason["code"] == "cut-by-box" && !reason["detail"].empty() && !reason["hint"].empty() &&
           std::abs(reason["places_mm"].at(0).at(2).get<double>() - 70) < 8;  // a cell, and a pixel
  })) << quality;
}

TEST_F(SolidCommand, FindsNoVerdictThatNobodyReads) {
  write_ball_scan(scan_, 8);
  Program program(
      command({"--leaf-size-mm", "2", "--clip-mm", "-140", "-140", "2", "140", "140", "70"}));
  EXPECT_EQ(program.wait(), 0) << program.errors();
  EXPECT_EQ(program.errors(), "");
  EXPECT_TRUE(fs::exists(output_));
}

TEST_F(SolidCommand, CallsAModelBadOfWhichHalfTheStopsAreMissing) {
  write_ball_scan(scan_, 8);
  Scan half = read_scan(scan_);
  half.shots.resize(4);
  write_scan(scan_, half);
  Program program(command({"--leaf-size-mm", "2", "--json"}));
  EXPECT_EQ(program.wait(), 0) << program.errors();
  EXPECT_EQ(program.errors().find("The model is bad: "), 0U) << program.errors();
  const auto quality = nlohmann::json::parse(program.output())["quality"];
  EXPECT_EQ(quality["verdict"], "bad");
  const auto& reason = quality["reasons"].at(0);
  EXPECT_EQ(reason["code"], "little-seen");
  EXPECT_EQ(
      reason["detail"],
      "the platform turned by 225 degrees without a stop: nobody saw that side of the object");
  EXPECT_EQ(reason["hint"], "Scan a whole turn.");
}

TEST_F(SolidCommand, TellsOfTheMoveThatTheLastLookSawAndMakesTheSameModel) {
  write_ball_scan(scan_, 8);
  report_of({"--leaf-size-mm", "2"});
  const std::string model = content_of(output_);
  write_object_move(scan_, {.shift = 0.0021, .shift_sigma = 0.0001});
  const auto quality = report_of({"--leaf-size-mm", "2"})["quality"];
  ASSERT_EQ(quality["reasons"].size(), 1U) << quality;
  EXPECT_EQ(quality["reasons"][0]["code"], "moved");
  EXPECT_NE(quality["reasons"][0]["detail"].get<std::string>().find("moved by 2.1 mm"),
            std::string::npos)
      << quality;
  EXPECT_TRUE(content_of(output_) == model);
}

TEST_F(SolidCommand, CutsErasesLaysScalesAndThinsAModel) {
  write_ball_scan(scan_, 8);
  // The lower half of the ball, hollowed by a small one, upside down at half its size.
  const auto report = report_of({"--leaf-size-mm",
                                 "2",
                                 "--cut-mm",
                                 "0",
                                 "0",
                                 "2",
                                 "60",
                                 "--cut-mm",
                                 "0",
                                 "0",
                                 "-1",
                                 "-20",
                                 "--erase-mm",
                                 "10",
                                 "-5",
                                 "60",
                                 "20",
                                 "--lay-mm",
                                 "0",
                                 "0",
                                 "1",
                                 "10",
                                 "-5",
                                 "60",
                                 "--scale",
                                 "0.5",
                                 "--max-triangles",
                                 "3000"});
  EXPECT_EQ(open_edges(content_of(output_)), 0);
  EXPECT_EQ(report["watertight"], true);
  EXPECT_LE(report["triangles"].get<int>(), 3000);
  EXPECT_FALSE(report.contains("quality"));
  EXPECT_FALSE(report.contains("shell_thickness_mm"));
  // A zone of a ball between planes 0 and 40 mm from its centre: pi h (R2 - h2 / 3).
  const double zone = std::numbers::pi * 4 * (25 - 16.0 / 3);
  const double hollow = 2.0 / 3 * std::numbers::pi * 8;
  const double expected = (zone - hollow) / 8;  // cm3
  EXPECT_NEAR(report["volume_cm3"].get<double>(), expected, expected * 0.04);
  EXPECT_NEAR(report["size_mm"][2].get<double>(), 20, 0.05);
  EXPECT_EQ(report["settings"]["cut_mm"],
            nlohmann::json::parse("[[0.0, 0.0, 1.0, 60.0], [0.0, 0.0, -1.0, -20.0]]"));
  EXPECT_EQ(report["settings"]["scale"], 0.5);
}

TEST_F(SolidCommand, RefusesEditsThatAreImpossible) {
  write_ball_scan(scan_, 2);
  expect_failure({"--cut-mm", "0", "0", "0", "5"}, 2, "cut_mm");
  expect_failure({"--erase-mm", "0", "0", "0", "-5"}, 2, "erase_mm");
  expect_failure({"--scale", "0"}, 2, "scale");
  expect_failure({"--method", "intersection", "--cut-mm", "0", "0", "1", "5"}, 2,
                 "--cut-mm: the method intersection has none");
  expect_failure({"--leaf-size-mm", "4", "--cut-mm", "0", "0", "1", "-5"}, 1, "no surface");
}

TEST_F(SolidCommand, MakesOneClosedPartAndReportsIt) {
  write_ball_scan(scan_, 8);
  const auto report = report_of({"--leaf-size-mm", "2"});
  const std::string stl = content_of(output_);
  EXPECT_EQ(open_edges(stl), 0);
  EXPECT_EQ(report["triangles"], triangles_of_whole_stl(stl));
  EXPECT_EQ(report["bytes"], stl.size());
  EXPECT_EQ(report["watertight"], true);
  EXPECT_EQ(report["parts"], 1);
  EXPECT_EQ(report["dropped_parts"], 0);
  EXPECT_EQ(report["dropped_volume_cm3"], 0);
  EXPECT_NEAR(report["seen_share"].get<double>() + report["filled_share"].get<double>(), 1, 1e-9);
  // The space below the ball was not seen and is filled in.
  EXPECT_GT(report["filled_share"].get<double>(), 0.02);
  EXPECT_LT(report["filled_share"].get<double>(), 0.4);
  const double ball_cm3 = 4.0 / 3 * std::numbers::pi * 5 * 5 * 5;
  // Planes are fitted to two samples, 4.2 mm apart, on each side, so they lie up to
  // 8.4^2 / (2 * 50) = 0.7 mm inside the ball, which is 3 * 0.7 / 50 of its volume.
  EXPECT_GT(report["volume_cm3"].get<double>(), (1 - 3 * 0.7 / 50) * ball_cm3);
  // At most the whole space between the ball's lower half and the platform, 6 cm below its centre,
  // is filled: only the rays that end on the ball show free space.
  const double below_cm3 = std::numbers::pi * 5 * 5 * 6 - ball_cm3 / 2;
  EXPECT_LT(report["volume_cm3"].get<double>(), ball_cm3 + below_cm3);
  EXPECT_NEAR(report["size_mm"][0].get<double>(), 100, 2);  // a voxel
  EXPECT_EQ(report["settings"]["method"], "solid");
  EXPECT_EQ(report["settings"]["max_error_mm"], 0.04);
  EXPECT_EQ(report["settings"]["parts"], "main");
  EXPECT_FALSE(report["settings"].contains("threshold_m2"));
}

TEST_F(SolidCommand, GivesTheSameBytesHoweverItIsAsked) {
  write_ball_scan(scan_, 4);
  const std::vector<std::string> plain{"--leaf-size-mm", "2", "--threads", "1"};
  Program to_file(command(plain));
  ASSERT_EQ(to_file.wait(), 0) << to_file.errors();
  const std::string expected = content_of(output_);
  EXPECT_GT(triangles_of_whole_stl(expected), 1000);

  Program two_threads(
      command({"--leaf-size-mm", "2", "--threads", "2", "--memory-limit-mb", "64"}));
  ASSERT_EQ(two_threads.wait(), 0) << two_threads.errors();
  EXPECT_TRUE(content_of(output_) == expected);

  auto words = command(plain);
  words[4] = "-";
  words.emplace_back("--json");
  Program to_output(words);
  EXPECT_EQ(to_output.wait(), 0);
  EXPECT_TRUE(to_output.output() == expected);
  EXPECT_TRUE(nlohmann::json::accept(to_output.errors())) << to_output.errors();
}

TEST_F(SolidCommand, TakesFewerTrianglesForALargerError) {
  write_ball_scan(scan_, 4);
  const auto triangles = [&](const std::string& max_error_mm) {
    const auto report = report_of({"--leaf-size-mm", "2", "--max-error-mm", max_error_mm});
    EXPECT_EQ(report["watertight"], true);
    return report["triangles"].get<int>();
  };
  const int all = triangles("0");
  const int usual = triangles("0.04");
  const int few = triangles("1");
  EXPECT_LT(usual, all);
  EXPECT_LT(few, usual / 2);
  EXPECT_GT(triangles("1000"), 3);  // at least a tetrahedron
}

TEST_F(SolidCommand, EndsWith2ForWhatItCannotTake) {
  write_ball_scan(scan_, 1);
  for (const char* const wrong : {"-1", "nan", "inf"}) {
    expect_failure({"--max-error-mm", wrong}, 2, "max_error_mm");
  }
  expect_failure({"--level", "8"}, 2, "--level");
  expect_failure({"--threshold-m2", "0.0001"}, 2, "--threshold-m2");
  expect_failure({"--leaf-size-mm", "0"}, 2, "leaf_size_mm");
  expect_failure({"--parts", "some"}, 2, "parts");
  Program no_number(command({"--max-error-mm", "small"}));
  EXPECT_EQ(no_number.wait(), 2);
  EXPECT_NE(no_number.errors().find("--max-error-mm"), std::string::npos);
  Program not_solid({octurn_program(), "reconstruct", scan_.string(), "-o", output_.string(),
                     "--method", "intersection", "--max-error-mm", "1"});
  EXPECT_EQ(not_solid.wait(), 2);
  EXPECT_NE(not_solid.errors().find("--max-error-mm"), std::string::npos);
}

TEST_F(SolidCommand, EndsWith1WhereMemoryIsTooLittle) {
  write_ball_scan(scan_, 1);
  expect_failure({"--memory-limit-mb", "20"}, 1, "memory limit");
}

TEST_F(SolidCommand, SaysThatAnEmptyPlatformHasNoSurface) {
  write_ball_scan(scan_, 3);
  const Eigen::Isometry3d pose = ball_sensor_pose();
  redraw(3, [&](int u, int v) {
    const Eigen::Vector3d ray =
        pose.linear() * Eigen::Vector3d((u - 320) / 575.8, (v - 240) / 575.8, 1);
    const double z = ray.z() < 0 ? -pose.translation().z() / ray.z() : 9;
    return static_cast<std::uint16_t>(z < 1.5 ? std::lround(z * 10000) : 0);
  });
  expect_failure({}, 1, "no surface");
}

TEST_F(SolidCommand, SaysThatDepthWithoutAReadingHasNoSurface) {
  write_ball_scan(scan_, 3);
  redraw(3, [](int, int) { return std::uint16_t{0}; });
  expect_failure({}, 1, "no surface");
}

TEST_F(SolidCommand, ClosesWhatOneSnapshotSaw) {
  write_ball_scan(scan_, 1);
  const auto report = report_of({"--leaf-size-mm", "2"});
  EXPECT_EQ(open_edges(content_of(output_)), 0);
  EXPECT_EQ(report["parts"], 1);
  EXPECT_GT(report["filled_share"].get<double>(), 0.2);
  // No ray passes beside the ball, so only the clip box bounds the filled space.
  EXPECT_GT(report["size_mm"][0].get<double>(), 95);
  EXPECT_LT(report["size_mm"][0].get<double>(), 280);
}

TEST(Solid, IsInTheHelp) {
  Program help({octurn_program(), "reconstruct", "--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_NE(help.output().find("solid: one closed, filled, smooth part"), std::string::npos);
  EXPECT_NE(help.output().find("--max-error-mm"), std::string::npos);
}

}  // namespace
}  // namespace octurn
