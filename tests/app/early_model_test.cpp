#include "build/early_model.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <stop_token>

#include "octurn/model.hpp"
#include "support/ball_scan.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

ReconstructOptions ball_options() {
  return {.method = Method::solid, .leaf_size = 0.004, .clip = ball_clip};
}

class EarlyModelTest : public testing::Test {
 protected:
  EarlyModelTest() { reconstruction_->add(snapshots_); }

  TemporaryFolder folder_;
  SnapshotSource snapshots_ = ball_scan(6);
  std::unique_ptr<Reconstructor> reconstruction_ = make_reconstructor(ball_options());
};

TEST_F(EarlyModelTest, HasTheBytesOfAModelThatIsMadeWhenItIsWanted) {
  EarlyModel early;
  early.begin(*reconstruction_, snapshots_, folder_.path() / "early.stl");
  const auto report = early.finish({});
  const auto wanted = write_model(*reconstruction_, snapshots_, folder_.path() / "wanted.stl", {});
  ASSERT_TRUE(report && wanted);
  EXPECT_EQ(report->triangles, wanted->triangles);
  EXPECT_EQ(report->volume, wanted->volume);
  EXPECT_TRUE(report->watertight);
  EXPECT_EQ(content_of(folder_.path() / "early.stl"), content_of(folder_.path() / "wanted.stl"));
}

TEST_F(EarlyModelTest, LeavesNothingWhereItIsGivenUp) {
  EarlyModel early;
  early.begin(*reconstruction_, snapshots_, folder_.path() / "Scan.stl");
  early.give_up();
  EXPECT_FALSE(early.has_begun());
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(EarlyModelTest, LeavesNothingWhereItIsStopped) {
  EarlyModel early;
  std::stop_source stop;
  stop.request_stop();
  early.begin(*reconstruction_, snapshots_, folder_.path() / "Scan.stl");
  early.finish(stop.get_token());
  EXPECT_FALSE(early.has_begun());
}

}  // namespace
}  // namespace octurn
