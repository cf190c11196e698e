// Scans with free poses: from another program's recording to a model, in one piece and by tiles.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
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
