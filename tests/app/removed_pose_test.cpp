// Scans of other poses that were removed from their scan, and their return from the bin.

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <string>

#include "octurn/file.hpp"
#include "store/scan_store.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// A scan with a model of its own, and a build that merges another pose of its object.
struct BothSides {
  explicit BothSides(ScanStore& store) {
    Job job = store.create({});
    Job other = store.create({}, PoseOf{.scan = job.id});
    for (Job* const scan : {&job, &other}) {
      scan->state = JobState::finished;
      scan->model = Model{};
      store.save(*scan);
    }
    first = job.id;
    pose = other.id;
    write_file(store.folder(first) / "Scan.stl", "alone");
    add_build(store, "both sides");
  }

  /// Adds a build of both poses, and chooses it.
  void add_build(ScanStore& store, const std::string& model) const {
    Build build{.number = store.next_build(first), .poses = {pose}};
    write_file(store.begin_build(first, build.number), model);
    store.add_build(first, build);
    store.choose_build(first, build.number);
  }

  std::string first = {};
  std::string pose = {};
};

TEST(RemovedPose, IsInTheBinByItselfAndJoinsItsScanAgain) {
  const TemporaryFolder data;
  std::optional<BothSides> scans;
  {
    ScanStore store(data.path());
    scans.emplace(store);
    scans->add_build(store, "both sides, finer");
    store.choose_build(scans->first, 1);
    store.discard_pose(scans->pose);
    EXPECT_TRUE(store.poses(scans->first).empty());
    EXPECT_EQ(content_of(store.model_file(scans->first)), "alone");
    EXPECT_TRUE(store.get(scans->first).builds.all.empty());
  }
  ScanStore store(data.path());
  ASSERT_TRUE(store.bin().find(scans->pose)) << "also after a restart";
  store.discard(scans->first);
  store.restore(scans->first);
  EXPECT_TRUE(store.bin().find(scans->pose)) << "it was removed before its scan";
  store.restore(scans->pose);
  EXPECT_EQ(store.poses(scans->first).size(), 1U);
  EXPECT_EQ(store.get(scans->first).builds.all.size(), 2U);
  EXPECT_EQ(content_of(store.model_file(scans->first)), "both sides");
  EXPECT_FALSE(store.get(scans->pose).pose_of->removed_build);
}

TEST(RemovedPose, ReturnsWithItsScan) {
  const TemporaryFolder data;
  ScanStore store(data.path());
  const BothSides scans(store);
  store.discard_pose(scans.pose);
  store.discard(scans.first);
  store.restore(scans.pose);
  EXPECT_TRUE(store.bin().is_empty());
  EXPECT_EQ(content_of(store.model_file(scans.first)), "both sides");
}

TEST(RemovedPose, LeavesTheModelOfAPoseThatWasMergedMeanwhile) {
  const TemporaryFolder data;
  ScanStore store(data.path());
  const BothSides scans(store);
  store.discard_pose(scans.pose);
  Build other{.number = store.next_build(scans.first), .poses = {"20260102-030405-0000"}};
  EXPECT_EQ(other.number, 1) << "the number that the removed pose's build had";
  write_file(store.begin_build(scans.first, other.number), "another side");
  store.add_build(scans.first, other);
  store.choose_build(scans.first, other.number);
  store.restore(scans.pose);
  EXPECT_EQ(content_of(store.model_file(scans.first)), "another side");
  EXPECT_EQ(content_of(store.model_file(scans.first, 2)), "both sides");
  EXPECT_EQ(store.get(scans.first).builds.all.size(), 2U);
}

TEST(RemovedPose, IsJoinedAgainIfAPowerCutInterruptedItsRemoval) {
  const TemporaryFolder data;
  std::optional<BothSides> scans;
  {
    ScanStore store(data.path());
    scans.emplace(store);
    store.discard_pose(scans->pose);
  }
  for (const auto& entry : fs::directory_iterator(data.path() / "bin")) {
    fs::rename(entry.path(), data.path() / "scans" / scans->pose);  // as before its last step
  }
  const ScanStore store(data.path());
  EXPECT_EQ(content_of(store.model_file(scans->first)), "both sides");
  EXPECT_FALSE(store.get(scans->pose).pose_of->removed_build);
}

}  // namespace
}  // namespace octurn
