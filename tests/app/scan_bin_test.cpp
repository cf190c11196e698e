// Deleted scans, and their return from the bin.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "store/job_file.hpp"
#include "store/scan_store.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

class ScanBinTest : public ::testing::Test {
 protected:
  /// Creates a finished scan with a model.
  Job finished(ScanStore& store, const std::optional<PoseOf>& pose_of = {}) {
    Job job = store.create({}, pose_of);
    job.state = JobState::finished;
    job.phase = Phase::done;
    job.model = Model{.report = {.triangles = 4}};
    std::ofstream(store.folder(job.id) / "Scan.stl") << "a model";
    store.save(job);
    return job;
  }

  fs::path scans() const { return folder_.path() / "scans"; }
  fs::path bin() const { return folder_.path() / "bin"; }
  /// The folder of the only deleted scan.
  fs::path binned() const { return fs::directory_iterator(bin())->path(); }

  TemporaryFolder folder_;
};

TEST_F(ScanBinTest, KeepsADeletedScanAsItWasAndGivesItBack) {
  ScanStore store(folder_.path());
  const Job job = finished(store);
  store.label(job.id, {.name = "Hase"});
  store.discard(job.id);
  EXPECT_FALSE(store.find(job.id));
  EXPECT_FALSE(fs::exists(store.folder(job.id)));
  ASSERT_EQ(store.bin().list().size(), 1U);
  EXPECT_EQ(store.bin().list().front().job.label.name, "Hase");

  store.restore(job.id);
  EXPECT_TRUE(store.bin().is_empty());
  Job named = job;
  named.label.name = "Hase";
  EXPECT_EQ(to_job_json(*store.find(job.id)), to_job_json(named));
  EXPECT_TRUE(fs::exists(store.model_file(job.id)));
}

TEST_F(ScanBinTest, IsThereForTheNextRunOfTheProgram) {
  std::string id;
  {
    ScanStore store(folder_.path());
    id = finished(store).id;
    store.discard(id);
  }
  ScanStore store(folder_.path());
  ASSERT_TRUE(store.bin().find(id));
  store.restore(id);
  EXPECT_EQ(store.find(id)->state, JobState::finished);
}

TEST_F(ScanBinTest, KeepsNoFileThatADeadProcessWasWriting) {
  std::string id;
  {
    ScanStore store(folder_.path());
    id = finished(store).id;
    put(store.folder(id) / ".name.txt.14653-0", "half a name");
    store.discard(id);
  }
  ScanStore store(folder_.path());
  store.restore(id);
  EXPECT_FALSE(fs::exists(store.folder(id) / ".name.txt.14653-0"));
  EXPECT_TRUE(fs::exists(store.model_file(id)));
}

TEST_F(ScanBinTest, IsEmptiedForGood) {
  ScanStore store(folder_.path());
  const Job job = finished(store);
  store.discard(job.id);
  store.empty_bin();
  EXPECT_TRUE(store.bin().is_empty());
  EXPECT_TRUE(fs::is_empty(bin()));
  EXPECT_EQ(code_thrown_by([&] { store.restore(job.id); }), "no-such-scan");
}

TEST_F(ScanBinTest, TakesTheOtherPosesWithTheirScan) {
  ScanStore store(folder_.path());
  const Job first = finished(store);
  const Job pose = finished(store, PoseOf{.scan = first.id});
  store.discard(first.id);
  EXPECT_TRUE(store.list().empty());
  store.restore(first.id);
  EXPECT_EQ(store.list().size(), 2U);
  EXPECT_EQ(store.poses(first.id).size(), 1U);
}

TEST_F(ScanBinTest, EndsWhatAPowerCutLeftHalfDone) {
  Job first;
  Job pose;
  {
    ScanStore store(folder_.path());
    first = finished(store);
    pose = finished(store, PoseOf{.scan = first.id});
    store.discard(first.id);
  }
  // Simulates a power cut before the pose was deleted, too.
  for (const auto& entry : fs::directory_iterator(bin())) {
    if (entry.path().string().find("." + pose.id) != std::string::npos) {
      fs::rename(entry.path(), scans() / pose.id);
    }
  }
  {
    ScanStore store(folder_.path());
    EXPECT_TRUE(store.list().empty());
    EXPECT_EQ(store.bin().list().size(), 2U);
  }
  // Simulates a power cut while the scans were being restored.
  for (const auto& entry : fs::directory_iterator(bin())) {
    if (entry.path().string().find("." + first.id) != std::string::npos) {
      fs::rename(entry.path(), scans() / first.id);
    }
  }
  const ScanStore store(folder_.path());
  EXPECT_EQ(store.list().size(), 2U);
  EXPECT_TRUE(store.bin().is_empty());
}

/// A clock of a test: so many days after the first of November.
WallClock clock_at(int day, bool is_right = true) {
  return {.now =
              [day] {
                return std::chrono::sys_days{std::chrono::year{2026} / 11 / 1} +
                       std::chrono::days(day);
              },
          .is_right = [is_right] { return is_right; }};
}

TEST_F(ScanBinTest, LosesWhatIsThereForMoreThanThirtyDays) {
  std::string id;
  {
    ScanStore store(folder_.path(), clock_at(0));
    id = finished(store).id;
    store.discard(id);
  }
  EXPECT_TRUE(ScanStore(folder_.path(), clock_at(29)).bin().find(id));
  EXPECT_FALSE(ScanStore(folder_.path(), clock_at(31)).bin().find(id));
  EXPECT_TRUE(fs::is_empty(bin()));
}

// A Pi without a network begins with the date of its image, and anybody may set its clock.
TEST_F(ScanBinTest, LosesNothingByAClockThatMayBeWrong) {
  std::string id;
  {
    ScanStore store(folder_.path(), clock_at(0));
    id = finished(store).id;
    store.discard(id);
  }
  EXPECT_TRUE(ScanStore(folder_.path(), clock_at(400, false)).bin().find(id));
  EXPECT_TRUE(ScanStore(folder_.path(), clock_at(-400, false)).bin().find(id));
}

TEST_F(ScanBinTest, CountsTheDaysFromWhenTheClockWasSet) {
  std::string id;
  {
    ScanStore store(folder_.path(), clock_at(-400, false));
    id = finished(store).id;
    store.discard(id);
  }
  EXPECT_TRUE(ScanStore(folder_.path(), clock_at(0)).bin().find(id)) << "deleted 400 days ago?";
  const auto scan = ScanStore(folder_.path(), clock_at(29)).bin().find(id);
  ASSERT_TRUE(scan);
  EXPECT_TRUE(scan->time_is_sure);
  EXPECT_FALSE(ScanStore(folder_.path(), clock_at(31)).bin().find(id));
}

/// Adds a file that takes that many bytes of the disk, and more for its name.
void add_file(const fs::path& file, std::uint64_t bytes) {
  std::ofstream stream(file, std::ios::binary);
  const std::string mb(std::size_t{1} << 20U, 'x');
  for (std::uint64_t written = 0; written < bytes; written += mb.size()) {
    stream << mb;
  }
}

TEST_F(ScanBinTest, GivesNoSpaceIfAllOfItDoesNotSuffice) {
  ScanStore store(folder_.path());
  for (int i = 0; i < 2; ++i) {
    store.discard(finished(store).id);
  }
  store.make_room(0, "nothing");
  EXPECT_EQ(store.bin().list().size(), 2U);
  const std::uint64_t more = std::uint64_t{1} << 40U;  // than others free on this disk meanwhile
  EXPECT_EQ(code_thrown_by([&] { store.make_room(store.free_bytes() + more, "more"); }),
            "disk-full");
  EXPECT_EQ(store.bin().list().size(), 2U);
}

TEST_F(ScanBinTest, NamesTheScansWhoseSpaceSuffices) {
  constexpr std::uint64_t mb = std::uint64_t{1} << 20U;
  ScanStore store(folder_.path());
  std::vector<std::string> ids;
  for (int i = 0; i < 3; ++i) {
    ids.push_back(finished(store).id);
    add_file(store.folder(ids.back()) / "snapshots.png", 2 * mb);
  }
  // The time of deletion is in whole seconds: renamed, so that the order is that of the ids.
  for (const std::string& id : ids) {
    store.discard(id);
    fs::rename(*std::ranges::find_if(fs::directory_iterator(bin()), fs::directory_iterator(),
                                     [&](const auto& entry) {
                                       return entry.path().string().find("." + id) !=
                                              std::string::npos;
                                     }),
               bin() / (id + "." + id));
  }
  const ScanBin binned(bin(), [](const fs::path&) { return Job(); });
  using Ids = std::vector<std::string>;
  EXPECT_EQ(binned.oldest(1), Ids({ids[0]}));
  EXPECT_EQ(binned.oldest(2 * mb), Ids({ids[0]}));
  EXPECT_EQ(binned.oldest(3 * mb), Ids({ids[0], ids[1]}));
  EXPECT_EQ(binned.oldest(6 * mb), ids);
  EXPECT_EQ(binned.oldest(8 * mb), Ids());

  // A file that has a name elsewhere is not freed.
  fs::create_hard_link(bin() / (ids[0] + "." + ids[0]) / "snapshots.png", scans() / "other.png");
  EXPECT_EQ(binned.oldest(mb), Ids({ids[0], ids[1]}));
  EXPECT_EQ(binned.oldest(6 * mb), Ids());
}

TEST_F(ScanBinTest, KeepsItsIdsFromNewScansAlthoughTheClockHasGoneBack) {
  const auto next_year = std::chrono::floor<ScanTime::duration>(std::chrono::system_clock::now()) +
                         std::chrono::days(400);
  {
    ScanStore store(folder_.path());
    const Job job = finished(store);
    store.discard(job.id);
    fs::rename(binned(), bin() / (to_scan_id(next_year) + "." + to_scan_id(next_year)));
  }
  ScanStore store(folder_.path());
  EXPECT_GT(store.create({}).id, to_scan_id(next_year));
}

}  // namespace
}  // namespace octurn
