#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <thread>

#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "sensor/recording.hpp"
#include "support/program.hpp"
#include "support/stl.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> command(const char* name, const fs::path& output,
                                 std::vector<std::string> more) {
  std::vector<std::string> words{
      octurn_program(), name, "--simulate", "--simulate-speed", "20", "-o", output};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(RecordCommand, SavesATurnThatIsScannedFrameForFrame) {
  const TemporaryFolder folder;
  const fs::path turn = folder.path() / "turn";
  Program record(command("record", turn, {"--snapshots", "4", "--frames", "3"}));
  ASSERT_EQ(record.wait(), 0) << record.errors();
  const Recording recording = read_recording(turn);
  ASSERT_EQ(recording.frames.size(), 12);

  Program scan(command("scan", folder.path() / "Scan.stl",
                       {"--sensor", turn, "--snapshots", "4", "--frames", "3", "--leaf-size-mm",
                        "4", "--data", folder.path() / "data"}));
  ASSERT_EQ(scan.wait(), 0) << scan.errors();
  EXPECT_EQ(open_edges(content_of(folder.path() / "Scan.stl")), 0);
  const fs::path stored = fs::directory_iterator(folder.path() / "data" / "scans")->path();
  const Scan kept = read_scan(stored);
  ASSERT_EQ(kept.shots.size(), 4);
  for (std::size_t shot = 0; shot < 4; ++shot) {
    std::vector<DepthFrame> frames;
    for (std::size_t frame = 0; frame < 3; ++frame) {
      EXPECT_NEAR(recording.frames[3 * shot + frame].angle, kept.shots[shot].angle, 1e-12);
      frames.push_back(read_recorded_frame(turn, recording, 3 * shot + frame));
    }
    EXPECT_NE(frames[0].depth, frames[1].depth);  // each has noise of its own
    EXPECT_EQ(read_snapshot(stored, kept, kept.shots[shot]).frame.depth,
              merge_frames(frames, DepthFilter::average).depth);
  }
}

TEST(RecordCommand, ReplaysTheFirstFrameFirst) {
  const TemporaryFolder folder;
  const fs::path turn = folder.path() / "turn";
  Program record(command("record", turn, {"--snapshots", "1", "--frames", "2"}));
  ASSERT_EQ(record.wait(), 0) << record.errors();
  Program scan(command("scan", folder.path() / "Scan.stl",
                       {"--sensor", turn, "--snapshots", "1", "--filter", "basic", "--leaf-size-mm",
                        "4", "--data", folder.path() / "data"}));
  ASSERT_EQ(scan.wait(), 0) << scan.errors();
  const fs::path stored = fs::directory_iterator(folder.path() / "data" / "scans")->path();
  const Scan kept = read_scan(stored);
  EXPECT_EQ(read_snapshot(stored, kept, kept.shots[0]).frame.depth,
            read_recorded_frame(turn, read_recording(turn), 0).depth);
}

TEST(RecordCommand, LeavesNothingWhenItIsInterrupted) {
  const TemporaryFolder folder;
  Program record(command("record", folder.path() / "turn", {"--frames", "100000"}));
  while (fs::is_empty(folder.path())) {
    std::this_thread::yield();
  }
  record.send_signal(SIGINT);
  EXPECT_EQ(record.wait(), 1);
  EXPECT_NE(record.errors().find("no recording was written"), std::string::npos) << record.errors();
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(RecordCommand, RefusesAFolderThatIsThere) {
  const TemporaryFolder folder;
  Program record(command("record", folder.path(), {"--snapshots", "1"}));
  EXPECT_EQ(record.wait(), 1);
  EXPECT_NE(record.errors().find("is there already"), std::string::npos) << record.errors();
}

TEST(RecordCommand, TakesAsManySnapshotsAsAScan) {
  const TemporaryFolder folder;
  Program most(command("record", folder.path(), {"--snapshots", "400"}));
  EXPECT_EQ(most.wait(), 1) << "the folder is there already";
  Program more(command("record", folder.path(), {"--snapshots", "401"}));
  EXPECT_EQ(more.wait(), 2);
  EXPECT_NE(more.errors().find("1 to 400"), std::string::npos) << more.errors();
}

TEST(RecordCommand, SaysHowItIsUsed) {
  Program help({octurn_program(), "record", "--help"});
  EXPECT_EQ(help.wait(), 0);
  EXPECT_NE(help.output().find("--snapshots"), std::string::npos);
  Program nothing({octurn_program(), "record", "--simulate"});
  EXPECT_EQ(nothing.wait(), 2);
}

}  // namespace
}  // namespace octurn
