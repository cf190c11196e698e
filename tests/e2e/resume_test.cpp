// Scans that are resumed after the program is killed or a device fails.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "octurn/scan_folder.hpp"
#include "support/daemon.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const std::string resumed_settings = R"({"snapshots": 4, "frames": 2, "leaf_size_mm": 4})";

/// A sensor without noise, whose frames depend on the stop only.
const std::vector<std::string> without_noise{"--sensor", "octurn-simulator://?noise=0&speed=20"};

std::string undisturbed_model() {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path(), without_noise);
  EXPECT_EQ(daemon.wait_until_done(daemon.start(resumed_settings))["state"], "finished");
  return daemon.get("/Scan.stl").body;
}

/// Parameter: the stop at which the daemon is killed.
class KilledDaemon : public ::testing::TestWithParam<int> {
 protected:
  /// Kills a daemon in a scan that has so many snapshots. @return the scan
  static std::string killed_scan(const fs::path& folder, int snapshots) {
    for (;;) {
      Daemon daemon(folder, without_noise);
      const std::string scan = daemon.start(resumed_settings);
      daemon.wait_until(scan, [&](const json& now) {
        return now["snapshots_done"] >= snapshots || now["state"] != "running";
      });
      daemon.program().send_signal(SIGKILL);
      EXPECT_EQ(daemon.program().wait(), -SIGKILL);
      if (stored_state(folder / "data", scan) == "running") {
        return scan;
      }
      // It ended before the signal: a busy machine may have delayed this process. Once more.
    }
  }
};

TEST_P(KilledDaemon, FinishesTheScanWhenItRunsAgain) {
  const std::string model = undisturbed_model();
  const TemporaryFolder folder;
  const std::string scan = killed_scan(folder.path(), GetParam());
  const Daemon daemon(folder.path(), without_noise);
  const json left = parsed(daemon.get(scan));
  ASSERT_EQ(left["state"], "interrupted");
  EXPECT_GE(left["snapshots_done"], GetParam());
  const Reply resumed = daemon.post(scan + "/resume", "");
  EXPECT_EQ(resumed.status, 202) << resumed.body;
  const json done = daemon.wait_until_done(scan);
  ASSERT_EQ(done["state"], "finished") << done;
  EXPECT_EQ(done["error"], nullptr);
  EXPECT_EQ(done["snapshots_done"], 4);
  EXPECT_TRUE(daemon.get(scan + "/Scan.stl").body == model);
}

INSTANTIATE_TEST_SUITE_P(AtEachStop, KilledDaemon, ::testing::Range(0, 4));

TEST(Resume, RefusesAScanThatIsNotPaused) {
  const TemporaryFolder folder;
  const Daemon daemon(folder.path());
  const std::string scan = daemon.start(endless);
  EXPECT_EQ(parsed(daemon.post(scan + "/resume", ""))["code"], "busy");
  EXPECT_EQ(daemon.post(scan + "/cancel", "").status, 202);
  ASSERT_EQ(daemon.wait_until_done(scan)["state"], "cancelled");
  const std::string other = daemon.start(endless);
  EXPECT_EQ(daemon.post(other + "/end", "").status, 202);
  ASSERT_EQ(daemon.wait_until_done(other)["can_resume"], true);
  const Reply refused = daemon.post(scan + "/resume", "");
  EXPECT_EQ(refused.status, 409);
  EXPECT_EQ(parsed(refused)["code"], "not-paused");
  EXPECT_EQ(daemon.post("/api/v1/scans/20261121-081500-3f2a/resume", "").status, 404);
}

TEST(Resume, EndsAnInterruptedScanThatIsCancelledAndMakesAModelOfWhatIsThere) {
  const TemporaryFolder folder;
  std::string scan;
  {
    Daemon daemon(folder.path());
    scan = daemon.start(endless);
    daemon.wait_until(scan, [](const json& now) { return now["snapshots_done"] >= 2; });
    daemon.program().send_signal(SIGKILL);
    daemon.program().wait();
  }
  const Daemon daemon(folder.path());
  EXPECT_EQ(daemon.post(scan + "/cancel", "").status, 202);
  const json ended = parsed(daemon.get(scan));
  EXPECT_EQ(ended["state"], "cancelled");
  EXPECT_GE(ended["snapshots_done"], 2);
  EXPECT_EQ(ended["can_resume"], true);
  const Reply model = daemon.get(scan + "/Scan.stl?leaf_size_mm=4");
  EXPECT_EQ(model.status, 200) << model.body;
  EXPECT_GT(model.body.size(), 84U);
}

// A recording with frames for every other stop only acts as a sensor that fails at the others.
TEST(ScanCommand, SaysHowToGoOnWithAPausedScan) {
  const TemporaryFolder folder;
  const auto octurn = [&](std::vector<std::string> words) {
    words.insert(words.begin(), octurn_program());
    words.insert(words.end(), {"--simulate", "--simulate-speed", "50"});
    return words;
  };
  const std::vector<std::string> scan{"scan",
                                      "--data",
                                      folder.path() / "data",
                                      "--snapshots",
                                      "4",
                                      "--frames",
                                      "2",
                                      "-o",
                                      folder.path() / "Scan.stl",
                                      "--sensor",
                                      folder.path() / "turn"};
  for (const char* const stops : {"2", "4"}) {
    fs::remove_all(folder.path() / "turn");
    Program record(
        octurn({"record", "-o", folder.path() / "turn", "--snapshots", stops, "--frames", "2"}));
    ASSERT_EQ(record.wait(), 0) << record.errors();
    if (std::string(stops) == "2") {
      Program paused(octurn(scan));
      EXPECT_EQ(paused.wait(), 1);
      EXPECT_NE(paused.errors().find("1 of 4 snapshots are in "), std::string::npos)
          << paused.errors();
      EXPECT_NE(paused.errors().find("--resume 2"), std::string::npos);
      EXPECT_FALSE(fs::exists(folder.path() / "Scan.stl"));
    }
  }
  const fs::path stored = fs::directory_iterator(folder.path() / "data" / "scans")->path();
  std::vector<std::string> resume = scan;
  resume.insert(resume.end(), {"--resume", stored.filename()});
  Program finished(octurn(resume));
  EXPECT_EQ(finished.wait(), 0) << finished.errors();
  EXPECT_EQ(read_scan(stored).shots.size(), 4U);
  EXPECT_TRUE(content_of(folder.path() / "Scan.stl") == content_of(stored / "Scan.stl"));
}

}  // namespace
}  // namespace octurn
