// Scans with free poses: from another program's recording to a model, in one piece and by tiles.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "support/program.hpp"
#include "support/room_scan.hpp"
#include "support/small_scan.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Spaces : public ::testing::Test {
 protected:
  /// Runs octurn, which must succeed. @return its standard output
  static std::string run(std::vector<std::string> words) {
    words.insert(words.begin(), octurn_program());
    Program program(words);
    EXPECT_EQ(program.wait(), 0) << program.errors();
    return program.output();
  }

  /// Runs octurn, which must fail with that status and one line with that text.
  static void expect_failure(std::vector<std::string> words, int status, const std::string& says) {
    words.insert(words.begin(), octurn_program());
    Program program(words);
    EXPECT_EQ(program.wait(), status) << program.errors();
    EXPECT_NE(program.errors().find(says), std::string::npos) << program.errors();
  }

  std::string in(const std::string& name) const { return (folder_.path() / name).string(); }

  TemporaryFolder folder_ = {};
};

TEST_F(Spaces, ARecordingInTumsLayoutIsImportedAndBuilt) {
  const std::string recording = std::string(OCTURN_GOLDEN) + "/tum_recording";
  run({"import", "tum", recording, "-o", in("scan"), "--intrinsics", "30,30,15.5,11.5"});

  const json scan = json::parse(content_of(in("scan/scan.json")));
  EXPECT_EQ(scan["version"], 2);
  EXPECT_EQ(scan["snapshots"].size(), 3U);
  EXPECT_DOUBLE_EQ(scan["sensor"]["depth_unit_m"], 0.0002);
  EXPECT_FALSE(scan.contains("clip_m"));
  EXPECT_EQ(content_of(in("scan/snapshots/001.png")),
            content_of(recording + "/depth/1305031102.194330.png"));

  for (const char* method : {"intersection", "solid"}) {
    const std::string line = run({"reconstruct", in("scan"), "--method", method, "--leaf-size-mm",
                                  "16", "-o", in("wall.stl"), "--json",
                                  method == std::string("solid") ? "--threads" : "--threshold-m2",
                                  method == std::string("solid") ? "1" : "0.01"});
    const json told = json::parse(line);
    EXPECT_TRUE(told["watertight"]) << line;
    EXPECT_GT(told["triangles"], 100) << line;
    EXPECT_EQ(told.contains("shell_thickness_mm"), method == std::string("solid"));
    EXPECT_TRUE(told["settings"]["clip_mm"].is_null()) << "it has no clip box: " << line;
  }
}

/// How a recording's poses may be written.
struct Written {
  double depth_unit = 0.0002;  // metres
  bool is_inverted = false;
  bool is_mirrored = false;
  bool is_back_to_front = false;
  std::vector<const char*> told = {};  // by the import
};

/// Writes twelve views of a room as a recording.
void write_recording(const fs::path& folder, const Written& written) {
  Room room = small_room();
  room.lens.depth_unit = written.depth_unit;
  std::ostringstream images;
  std::ostringstream poses;
  for (int i = 0; i < 12; ++i) {
    const std::string file = std::to_string(i) + ".png";
    write_depth_png(folder / "depth" / file, room_snapshot(room, i).frame);
    const Eigen::Vector4d mirror(1, written.is_mirrored ? -1 : 1, 1, 1);
    Eigen::Matrix4d pose = mirror.asDiagonal() * room_pose(room, i).matrix() * mirror.asDiagonal();
    pose.middleCols<2>(1) *= written.is_back_to_front ? -1 : 1;
    pose = written.is_inverted ? Eigen::Matrix4d(pose.inverse()) : pose;
    const Eigen::Quaterniond turn(Eigen::Matrix3d(pose.topLeftCorner<3, 3>()));
    images << i << " depth/" << file << '\n';
    poses << i << ' ' << pose.topRightCorner<3, 1>().transpose() << ' ' << turn.coeffs().transpose()
          << '\n';
  }
  put(folder / "depth.txt", images.str());
  put(folder / "groundtruth.txt", poses.str());
}

TEST_F(Spaces, ARecordingTellsItsDepthUnitAndWhatItsPosesMean) {
  const std::vector<Written> conventions{
      {.told = {}},
      {.depth_unit = 0.001, .told = {"unit is 1 mm", "as written"}},
      {.is_inverted = true, .told = {"are inverted"}},
      {.is_back_to_front = true, .told = {"are turned"}},
      {.is_mirrored = true, .told = {"were mirrored"}},
      {.depth_unit = 0.001,
       .is_inverted = true,
       .is_mirrored = true,
       .told = {"unit is 1 mm", "are inverted", "were mirrored"}}};
  for (std::size_t n = 0; n < conventions.size(); ++n) {
    const std::string name = std::to_string(n);
    write_recording(in("recording" + name), conventions[n]);
    Program import({octurn_program(), "import", "tum", in("recording" + name), "-o", in(name),
                    "--intrinsics", "120,120,80,60"});
    ASSERT_EQ(import.wait(), 0) << import.errors();
    for (const char* told : conventions[n].told) {
      EXPECT_NE(import.errors().find(told), std::string::npos) << n << ": " << import.errors();
    }
    EXPECT_EQ(import.errors().find("as written") == std::string::npos, n == 0) << import.errors();
    const Scan scan = read_scan(in(name));
    EXPECT_EQ(scan.intrinsics.depth_unit, conventions[n].depth_unit) << n;
    for (int i = 0; i < 12; ++i) {
      EXPECT_TRUE(scan.shots[static_cast<std::size_t>(i)].object_from_sensor->isApprox(
          room_pose(small_room(), i), 1e-4))
          << n;
    }
  }
  const json told = json::parse(run({"reconstruct", in("0"), "--leaf-size-mm", "16",
                                     "--threshold-m2", "0.01", "-o", in("room.stl"), "--json"}));
  EXPECT_GT(told["views"]["agreeing"], 20 * told["views"]["contradicted"].get<int>()) << told;
  EXPECT_LT(told["views"]["disagreement_mm"], 5) << told;
}

TEST_F(Spaces, ADepthUnitThatIsGivenIsTakenAndDoubted) {
  write_recording(in("recording"), {.depth_unit = 0.001});
  Program import({octurn_program(), "import", "tum", in("recording"), "-o", in("scan"),
                  "--intrinsics", "120,120,80,60", "--depth-unit-m", "0.0001"});
  ASSERT_EQ(import.wait(), 0) << import.errors();
  EXPECT_NE(import.errors().find("look at the depth unit"), std::string::npos) << import.errors();
  EXPECT_EQ(read_scan(in("scan")).intrinsics.depth_unit, 0.0001);
}

TEST_F(Spaces, AnImportThatFailsLeavesNothing) {
  put(in("recording/depth.txt"), "1 depth/1.png\n");
  put(in("recording/groundtruth.txt"), "1 0 0 0 0 0 0 1\n");
  expect_failure({"import", "tum", in("recording"), "-o", in("scan")}, 1, "1.png");
  put(in("recording/depth/1.png"), "no picture");
  expect_failure({"import", "tum", in("recording"), "-o", in("scan")}, 1, "1.png");
  expect_failure({"import", "tum", in("recording"), "-o", in("scan"), "--intrinsics", "x"}, 2,
                 "freiburg1");

  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST_F(Spaces, TilesJoinToTheBytesOfOneProcess) {
  write_room_scan(in("room"), small_room(), 8);
  for (const std::string method : {"intersection", "solid"}) {
    std::vector<std::string> options{"--leaf-size-mm", "32"};
    if (method == "solid") {
      options.insert(options.end(), {"--method", "solid"});
    } else {  // the default of a space
      options.insert(options.end(), {"--threshold-m2", "0.01"});
    }
    const auto reconstruct = [&](std::vector<std::string> words) {
      words.insert(words.begin(), {"reconstruct", in("room")});
      words.insert(words.end(), options.begin(), options.end());
      return run(words);
    };
    reconstruct({"-o", in("whole.stl"), "--memory-limit-mb", "64"});

    const json plan = json::parse(reconstruct({"--plan", "-o", in("plan.json")}));
    std::vector<std::string> join{"join", "-o", in("joined.stl")};
    for (const json& tile : plan["tiles"]) {
      EXPECT_EQ(tile["tile"], join.size() - 3);
      EXPECT_EQ(tile["index"].size(), 3U);
      EXPECT_GT(tile["snapshots"], 0);
      EXPECT_GT(tile["megabytes"], 1);
      EXPECT_EQ(tile.size(), 4U);
      const std::string number = tile["tile"].dump();
      join.push_back(in(number + ".tile"));
      std::vector<std::string> make{"--tile", number, "-o", join.back()};
      if (tile["tile"] != 0) {  // tile 0 is made without a plan file
        make.insert(make.end(), {"--plan-file", in("plan.json")});
      }
      reconstruct(make);
    }
    run(join);

    EXPECT_GT(plan["tiles"].size(), 3U);
    EXPECT_EQ(open_edges(content_of(in("whole.stl"))), 0);
    EXPECT_TRUE(content_of(in("joined.stl")) == content_of(in("whole.stl"))) << method;

    fs::remove(in("joined.stl"));
    join.pop_back();
    expect_failure(join, 1, "is missing");
    EXPECT_FALSE(fs::exists(in("joined.stl")));
  }
}

TEST_F(Spaces, TilesAreOfScansWithFreePosesAlone) {
  write_small_scan(in("turn"), 2);

  expect_failure({"reconstruct", in("turn"), "--plan"}, 2, "has no tiles");
  expect_failure({"reconstruct", in("turn"), "--tile", "0", "-o", in("0.tile")}, 2, "has no tiles");
  expect_failure({"reconstruct", in("turn")}, 2, "--output");
  EXPECT_FALSE(fs::exists(in("0.tile")));
}

}  // namespace
}  // namespace octurn
