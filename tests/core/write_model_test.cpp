#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "octurn/model.hpp"
#include "support/ball_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

std::unique_ptr<Reconstructor> ball(const SnapshotSource& snapshots, const Box& clip = ball_clip) {
  std::unique_ptr<Reconstructor> reconstructor =
      make_reconstructor({.leaf_size = 0.004, .clip = clip});
  reconstructor->add(snapshots);
  return reconstructor;
}

TEST(WriteModel, ReportsTheFileThatItWrote) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "Scan.stl";
  const SnapshotSource snapshots = ball_scan(8);
  const std::unique_ptr<Reconstructor> reconstructor = ball(snapshots);

  const auto report = write_model(*reconstructor, snapshots, file, {});

  ASSERT_TRUE(report);
  EXPECT_EQ(report->bytes, std::filesystem::file_size(file));
  EXPECT_EQ(report->triangles, reconstructor->count(snapshots).facets);
  EXPECT_GT(report->leaves, 0U);
  EXPECT_TRUE(report->watertight);
  // Leaves reach at most one side, 3.9 mm, beyond the ball, which is seen from all around.
  EXPECT_GT(report->size.x(), 2 * ball_radius - 0.004);
  EXPECT_LT(report->size.x(), 2 * (ball_radius + 0.004));
}

TEST(WriteModel, IsThatOfTheStreamedFacets) {
  const TemporaryFolder folder;
  const SnapshotSource snapshots = ball_scan(3);
  const std::unique_ptr<Reconstructor> reconstructor = ball(snapshots);
  std::vector<Facet> streamed;

  write_model(*reconstructor, snapshots, folder.path() / "Scan.stl", {});
  const auto report = write_model(*reconstructor, snapshots,
                                  [&](std::span<const Facet> facets) {
                                    streamed.insert(streamed.end(), facets.begin(), facets.end());
                                  },
                                  {});

  ASSERT_TRUE(report);
  EXPECT_EQ(report->triangles, streamed.size());
  EXPECT_EQ(content_of(folder.path() / "Scan.stl"), stl_text(streamed));
}

TEST(WriteModel, RefusesAnEmptyModelAndWritesNoFile) {
  const TemporaryFolder folder;
  const SnapshotSource snapshots = ball_scan(1);
  const Box nothing_there{.min = {0.4, 0.4, 0.8}, .max = {0.45, 0.45, 0.9}};
  const std::unique_ptr<Reconstructor> reconstructor = ball(snapshots, nothing_there);

  EXPECT_EQ(code_thrown_by(
                [&] { write_model(*reconstructor, snapshots, folder.path() / "Scan.stl", {}); }),
            "empty");
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(WriteModel, WritesNoFileWhenStoppedByItsTokenOrItsSink) {
  const TemporaryFolder folder;
  const SnapshotSource snapshots = ball_scan(2);
  const std::unique_ptr<Reconstructor> reconstructor = ball(snapshots);
  std::stop_source stop;
  stop.request_stop();

  EXPECT_FALSE(
      write_model(*reconstructor, snapshots, folder.path() / "Scan.stl", stop.get_token()));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_FALSE(
      write_model(*reconstructor, snapshots, [](std::span<const Facet>) { throw Stopped{}; }, {}));
}

TEST(StoredSnapshots, AreThoseOfTheFolderUntilAStopIsRequested) {
  const TemporaryFolder folder;
  write_ball_scan(folder.path(), 2);
  const Scan scan = read_scan(folder.path());
  std::stop_source stop;
  const SnapshotSource stored = stored_snapshots(folder.path(), scan, stop.get_token());

  ASSERT_EQ(stored.count, 2U);
  EXPECT_EQ(stored.read(1).frame.depth,
            read_snapshot(folder.path(), scan, scan.shots[1]).frame.depth);
  stop.request_stop();
  EXPECT_THROW(stored.read(1), Stopped);
}

}  // namespace
}  // namespace octurn
