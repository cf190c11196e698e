#include <gtest/gtest.h>

#include <optional>
#include <span>

#include "app/few_snapshots.hpp"
#include "build/early_model.hpp"
#include "octurn/model.hpp"
#include "octurn/scan_folder.hpp"
#include "run/run_scan.hpp"
#include "support/ball_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr std::size_t mb = std::size_t{1} << 20U;

ReconstructOptions fine_options(std::size_t limit_mb) {
  return {.method = Method::solid,
          .leaf_size = 0.0005,
          .clip = ball_clip,
          .memory_limit = limit_mb * mb};
}

TEST(FittingReconstruction, BecomesCoarserAsLongAsTheModelDoesNotFit) {
  FittingReconstruction reconstruction(fine_options(24));
  const SnapshotSource snapshots = ball_scan(6);
  std::optional<ModelReport> report;
  const auto make = [&] {
    (*reconstruction).add(snapshots);
    report = write_model(*reconstruction, snapshots, [](std::span<const Facet>) {}, {});
  };
  const Error error = error_thrown_by(make);
  ASSERT_EQ(error.code(), ErrorCode::memory_limit);
  EXPECT_EQ(error.parameters(), (Parameters{{"limit_mb", 24.0}}));
  reconstruction.make_coarser(error);
  make();
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->watertight);
  EXPECT_NEAR(report->size.x(), 0.1, 0.002);  // the ball's width
  Quality quality;
  reconstruction.add_coarser_reason(quality);
  ASSERT_EQ(quality.reasons.size(), 1U);
  EXPECT_EQ(quality.verdict, Verdict::look);
  EXPECT_EQ(quality.reasons[0].code, coarser_code);
  EXPECT_EQ(quality.reasons[0].detail,
            "leaves of 0.5 mm did not fit into 24 MB: the model has leaves of 1 mm");
}

TEST(FittingReconstruction, StaysAsItIsForAnyOtherError) {
  FittingReconstruction reconstruction(fine_options(0));
  EXPECT_EQ(
      code_thrown_by([&] { reconstruction.make_coarser(Error(ErrorCode::write_failed, "no")); }),
      "write-failed");
  Quality quality;
  reconstruction.add_coarser_reason(quality);
  EXPECT_EQ(quality, Quality());
}

TEST(FittingReconstruction, KeepsAScanWhoseModelDoesNotFit) {
  const TemporaryFolder folder;
  Rig rig({.sensor_uri = "octurn-simulator://?speed=20", .speed = 20});
  ScanSettings settings = few_snapshots();
  settings.method = Method::solid;
  settings.pose = PoseSource::configured;
  settings.leaf_size = 0.0005;
  const auto model = run_scan(settings, {.threads = 1, .memory_bytes = 36 * mb}, folder.path(),
                              *make_capture(rig), {}, {});
  ASSERT_TRUE(model);
  EXPECT_TRUE(model->report.watertight);
  EXPECT_EQ(read_scan(folder.path()).shots.size(), 3U);
  ASSERT_FALSE(model->quality->reasons.empty());
  EXPECT_EQ(model->quality->reasons.back().code, coarser_code);
}

}  // namespace
}  // namespace octurn
