// Scans that solve the sensor's pose, over HTTP.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/daemon.hpp"
#include "support/wrong_pose.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string wrongly_told(const json& more = json::object()) {
  json settings{{"snapshots", 12},
                {"frames", 2},
                {"leaf_size_mm", 2},
                {"platform_from_sensor", to_rows(wrong_pose())}};
  settings.update(more);
  return settings.dump();
}

fs::path folder_of(const TemporaryFolder& folder, const json& scan) {
  return folder.path() / "data" / "scans" / scan["id"].get<std::string>();
}

json calibration_in(const fs::path& scan) {
  return json::parse(content_of(scan / "scan.json"))["calibration"];
}

/// Whether the pose is solved, and the model is built again.
bool is_rebuilding(const json& scan) {
  return scan["phase"] == "rebuilding" || scan["phase"] == "building" || scan["state"] != "running";
}

/// Compares solved poses to four units in the last place: a sigma is stored in degrees and used in
/// radians.
void expect_same(const json& pose, const json& expected) {
  const json numbers = pose.flatten();
  const json wanted = expected.flatten();
  for (const auto& [key, value] : wanted.items()) {
    EXPECT_DOUBLE_EQ(numbers.at(key).get<double>(), value.get<double>()) << key;
  }
}

TEST(ScanCalibration, TellsWhatWasSolvedAndKeepsWhatWasTold) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json done = daemon.wait_until_done(daemon.start(wrongly_told()));
  ASSERT_EQ(done["state"], "finished") << done;
  const json& calibration = done["calibration"];
  EXPECT_EQ(calibration["accepted"], true) << calibration;
  EXPECT_EQ(calibration["confirms_told"], false);
  EXPECT_EQ(calibration["reason"], "");
  EXPECT_EQ(calibration["rebuilt"], 12);
  EXPECT_LT(calibration["solved"]["after_mm"], calibration["solved"]["before_mm"]);
  const json stored = calibration_in(folder_of(folder, done));
  EXPECT_EQ(stored["platform_from_sensor"], to_rows(wrong_pose()));
  EXPECT_EQ(stored["solved"], calibration["solved"]);
  EXPECT_EQ(done["settings"]["platform_from_sensor"], to_rows(wrong_pose()));

  for (const char* const source : {"auto", "told"}) {
    Program again({octurn_program(), "reconstruct", folder_of(folder, done), "-o", "-",
                   "--leaf-size-mm", "2", "--method", "solid", "--calibrate", source});
    EXPECT_EQ(again.wait(), 0) << again.errors();
    EXPECT_EQ(again.output() == daemon.get("/Scan.stl").body, std::string(source) == "auto");
  }
}

TEST(ScanCalibration, LeavesAToldPoseAloneThatIsAskedFor) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const json done = daemon.wait_until_done(daemon.start(wrongly_told({{"calibrate", "told"}})));
  EXPECT_EQ(done["state"], "finished") << done;
  EXPECT_EQ(done["calibration"], nullptr);
  EXPECT_FALSE(calibration_in(folder_of(folder, done)).contains("solved"));
}

TEST(ScanCalibration, IsCancelledWhileTheModelIsBuiltAgain) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan =  // small leaves, which take a while
      daemon.start(wrongly_told({{"leaf_size_mm", 0.2}, {"method", "intersection"}}));
  const json now = daemon.wait_until(scan, is_rebuilding);
  ASSERT_EQ(now["state"], "running") << now;
  EXPECT_EQ(now["calibration"]["accepted"], true);
  EXPECT_EQ(daemon.post(scan + "/cancel", "").status, 202);
  const json done = daemon.wait_until_done(scan);
  EXPECT_EQ(done["state"], "cancelled");
  EXPECT_EQ(done["snapshots_done"], 12);
  EXPECT_FALSE(fs::exists(folder_of(folder, done) / "Scan.stl"));
}

TEST(ScanCalibration, GoesOnAfterAKillWhileTheModelIsBuiltAgain) {
  const TemporaryFolder folder;
  std::string scan;
  json before;
  do {  // once more where the scan ended before the signal
    Daemon daemon(folder.path());
    scan = daemon.start(wrongly_told({{"leaf_size_mm", 0.6}, {"method", "intersection"}}));
    before = daemon.wait_until(scan, is_rebuilding);
    daemon.program().send_signal(SIGKILL);
    EXPECT_EQ(daemon.program().wait(), -SIGKILL);
  } while (stored_state(folder.path() / "data", scan) == "finished");
  const Daemon daemon(folder.path());
  const json left = parsed(daemon.get(scan));
  ASSERT_EQ(left["state"], "interrupted");
  expect_same(left["calibration"]["solved"], before["calibration"]["solved"]);
  EXPECT_EQ(daemon.post(scan + "/resume", "").status, 202);
  const json done = daemon.wait_until_done(scan);
  ASSERT_EQ(done["state"], "finished") << done;
  expect_same(calibration_in(folder_of(folder, done))["solved"], before["calibration"]["solved"]);
  Program again({octurn_program(), "reconstruct", folder_of(folder, done), "-o", "-",
                 "--leaf-size-mm", "0.6", "--method", "intersection", "--calibrate", "auto"});
  EXPECT_EQ(again.wait(), 0) << again.errors();
  EXPECT_TRUE(again.output() == daemon.get("/Scan.stl").body);
}

}  // namespace
}  // namespace octurn
