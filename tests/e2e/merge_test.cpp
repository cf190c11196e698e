// `octurn merge`, end to end.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/register/laid_down.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t stops = 8;
constexpr std::size_t few_stops = 4;  // for tests that need no accuracy

/// The volume of a shape above the platform, counted in cubes of 2 mm.
double volume_cm3(const Shape& shape) {
  constexpr double side = 0.002;
  double volume = 0;
  for (int x = -40; x < 40; ++x) {
    for (int y = -40; y < 40; ++y) {
      for (int z = 0; z < 70; ++z) {
        volume += shape(side * Eigen::Vector3d(x + 0.5, y + 0.5, z + 0.5)) < 0 ? 1 : 0;
      }
    }
  }
  return cm3_from_m3(volume * side * side * side);
}

class MergeCommand : public ::testing::Test {
 protected:
  /// Stores a turn as a scan with a solved pose. @return the scan's folder
  fs::path write_solved_turn(const std::string& name, const RegistrationTurn& turn) const {
    const fs::path folder = write_turn(name, turn);
    write_solved_pose(folder, {.platform_from_sensor = turn.platform_from_sensor,
                               .position_sigma = 1e-4,
                               .direction_sigma = 1e-4});
    return folder;
  }

  /// Stores a turn as a scan. @return the scan's folder
  fs::path write_turn(const std::string& name, const RegistrationTurn& turn) const {
    const fs::path folder = folder_.path() / name;
    fs::create_directories(folder / "snapshots");
    Scan scan{.sensor_name = "test",
              .intrinsics = turn.intrinsics,
              .platform_from_sensor = turn.platform_from_sensor,
              .clip = turn.clip};
    for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
      scan.shots.push_back({.file = shot_file(static_cast<int>(stop)), .angle = turn.angles[stop]});
      write_depth_png(folder / scan.shots.back().file, turn.read(stop));
    }
    write_scan(folder, scan);
    return folder;
  }

  /// The output of `octurn merge --json`; fails unless it ends with that status.
  json merge(int status, const fs::path& one, const fs::path& other) const {
    Program program({octurn_program(), "merge", one.string(), other.string(), "-o",
                     merged_.string(), "--json"});
    EXPECT_EQ(program.wait(), status) << program.errors();
    return json::parse(program.output());
  }

  TemporaryFolder folder_;
  fs::path merged_ = folder_.path() / "merged";
};

TEST_F(MergeCommand, MakesOneScanOfAnObjectThatWasTurnedOver) {
  const json report =
      merge(0, write_turn("a", laid_turn(figure(), stops)),
            write_turn("b", laid_turn(figure(), stops, turned_over(figure_height))));

  EXPECT_TRUE(report["accepted"]);
  EXPECT_FALSE(report["symmetric"]);
  EXPECT_EQ(json::parse(content_of(merged_ / "scan.json"))["version"], 2);
  for (const ScanPose& pose : read_scan(merged_).poses) {
    EXPECT_GT(pose.clip.max.z(), figure_height);
    EXPECT_LT(pose.clip.max.z(), figure_height + 0.03) << "empty space costs time and memory";
  }
  const fs::path model = folder_.path() / "Scan.stl";
  Program program(
      {octurn_program(), "reconstruct", merged_.string(), "-o", model.string(), "--json"});
  ASSERT_EQ(program.wait(), 0) << program.errors();
  const json built = json::parse(program.output());
  EXPECT_TRUE(built["watertight"]);
  EXPECT_EQ(built["parts"], 1);  // a cavity would count as a second part
  const double volume = volume_cm3(figure());
  // The space between the balls and the block that neither pose sees is filled in.
  EXPECT_NEAR(built["volume_cm3"], volume, 0.03 * volume);

  const fs::path by_library = folder_.path() / "library.stl";
  Program example({example_program(), merged_.string(), by_library.string()});
  ASSERT_EQ(example.wait(), 0) << example.errors();
  EXPECT_TRUE(content_of(by_library) == content_of(model));
}

TEST_F(MergeCommand, TakesTheCandidateOrThePairsThatAPersonTells) {
  const fs::path one = write_solved_turn("a", laid_turn(figure(), few_stops));
  const fs::path other =
      write_solved_turn("b", laid_turn(figure(), few_stops, turned_over(figure_height)));
  const auto run = [&](std::vector<std::string> told) {
    std::vector<std::string> arguments{
        octurn_program(), "merge", one.string(), other.string(), "-o", merged_.string(), "--json"};
    arguments.insert(arguments.end(), told.begin(), told.end());
    return Program(arguments);
  };
  Program best = run({"--candidate", "0"});
  ASSERT_EQ(best.wait(), 0) << best.errors();
  const json report = json::parse(best.output());
  EXPECT_GE(report["candidates"].size(), 2U);
  fs::remove_all(merged_);

  std::vector<std::string> pairs{"--pairs"};
  for (const Eigen::Vector3d& point :
       {Eigen::Vector3d(0.03, 0.01, 0.02), Eigen::Vector3d(-0.03, 0.01, 0.05),
        Eigen::Vector3d(0, -0.02, 0.1)}) {
    // A person clicks some millimetres off.
    const Eigen::Vector3d object = turned_over(figure_height) * point;
    for (const double metres :
         {object.x() + 0.003, object.y(), object.z(), point.x(), point.y(), point.z() - 0.002}) {
      pairs.push_back(std::to_string(mm_from_metres(metres)));
    }
  }
  Program by_pairs = run(pairs);
  ASSERT_EQ(by_pairs.wait(), 0) << by_pairs.errors();
  const json told = json::parse(by_pairs.output());
  for (std::size_t row = 0; row < 3; ++row) {
    EXPECT_NEAR(told["poses"][1]["object_from_platform"][row][3],
                report["poses"][1]["object_from_platform"][row][3], 1e-4);
  }

  fs::remove_all(merged_);
  Program none = run({"--candidate", "99"});
  EXPECT_EQ(none.wait(), 2) << none.errors();
  pairs.pop_back();
  Program odd = run(pairs);
  EXPECT_EQ(odd.wait(), 2) << odd.errors();
  EXPECT_FALSE(fs::exists(merged_));
}

// All its equivalent poses give the same model.
TEST_F(MergeCommand, TakesASymmetricObjectAndSaysSo) {
  constexpr double height = 0.07;
  const Shape round = cylinder(0.03, height);

  const json report =
      merge(0, write_solved_turn("a", laid_turn(round, few_stops)),
            write_solved_turn("b", laid_turn(round, few_stops, turned_over(height))));

  EXPECT_TRUE(report["symmetric"]);
  Program program({octurn_program(), "reconstruct", merged_.string(), "-o",
                   (folder_.path() / "Scan.stl").string(), "--method", "intersection", "--json"});
  ASSERT_EQ(program.wait(), 0) << program.errors();
  EXPECT_TRUE(json::parse(program.output())["watertight"]);
}

// The dent in the underside, which the first turn did not see, may be at any of four corners.
TEST_F(MergeCommand, RefusesToGuessBetweenTwoShapesWithExit1) {
  const Shape dented = [whole = block({0.08, 0.08, 0.05}), dent = ball({0.018, 0.018, 0}, 0.015)](
                           const Eigen::Vector3d& p) { return std::max(whole(p), -dent(p)); };

  const json report = merge(1, write_solved_turn("a", laid_turn(dented, stops)),
                            write_solved_turn("b", laid_turn(dented, stops, turned_over(0.05))));

  EXPECT_NE(std::string(report["reason"]).find("different shapes"), std::string::npos) << report;
  EXPECT_FALSE(fs::exists(merged_));
}

TEST_F(MergeCommand, RefusesTwoObjectsWithExit1) {
  const Shape other = joined(block({0.1, 0.03, 0.05}), ball({0.03, 0, 0.06}, 0.03));

  const json report = merge(1, write_solved_turn("a", laid_turn(figure(), few_stops)),
                            write_solved_turn("b", laid_turn(other, few_stops)));

  EXPECT_FALSE(report["accepted"]);
  EXPECT_NE(report["reason"], "");
  EXPECT_FALSE(fs::exists(merged_));
}

}  // namespace
}  // namespace octurn
