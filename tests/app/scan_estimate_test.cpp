#include "store/scan_estimate.hpp"

#include <gtest/gtest.h>

#include "turntable/motion.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;
using Seconds = std::chrono::duration<double>;

EarlierScan earlier(const ScanSettings& settings, Seconds elapsed, Seconds build) {
  Job job{.state = JobState::finished, .times = {.elapsed = elapsed}, .settings = settings};
  job.model = Model{.report = {.bytes = 1'000'000}, .build_time = build};
  return {.job = job, .snapshot_bytes = 100'000U * static_cast<unsigned>(settings.snapshots)};
}

const ScanSettings usual{.snapshots = 9, .leaf_size = 0.001};

TEST(ScanEstimate, IsWhatTheSameScanTookBefore) {
  const ScanEstimate estimate = estimate_scan({earlier(usual, 25s, 5s)}, usual);
  EXPECT_TRUE(estimate.is_measured);
  EXPECT_DOUBLE_EQ(estimate.stop.count(), 2);  // nine stops and the last look
  EXPECT_DOUBLE_EQ(estimate.build.count(), 5);
  EXPECT_DOUBLE_EQ(estimate.total(9).count(), 25);
  EXPECT_EQ(estimate.bytes, 1'900'000U);
}

TEST(ScanEstimate, IsTheMedianOfTheLastFive) {
  std::vector<EarlierScan> scans;
  for (const Seconds build : {1s, 9s, 2s, 8s, 3s, 100s, 100s, 100s}) {
    scans.push_back(earlier(usual, 20s + build, build));
  }
  EXPECT_DOUBLE_EQ(estimate_scan(scans, usual).build.count(), 3);
}

TEST(ScanEstimate, IsTakenFromTheScanThatIsMostAlike) {
  ScanSettings coarse = usual;
  coarse.leaf_size = 0.004;
  coarse.snapshots = 18;
  const std::vector scans{earlier(coarse, 40s, 2s), earlier(usual, 25s, 5s)};
  EXPECT_DOUBLE_EQ(estimate_scan(scans, usual).build.count(), 5);
  EXPECT_DOUBLE_EQ(estimate_scan(scans, usual).stop.count(), 2);
}

TEST(ScanEstimate, OfAModelGrowsAsTheSquareOfOneOverTheLeafSize) {
  ScanSettings fine = usual;
  fine.leaf_size = 0.0005;
  const ScanEstimate estimate = estimate_scan({earlier(usual, 25s, 5s)}, fine);
  EXPECT_DOUBLE_EQ(estimate.build.count(), 20);
  EXPECT_EQ(estimate.bytes, 4'900'000U);
}

TEST(ScanEstimate, GuessesThatTheTurnToAFartherStopTakesLonger) {
  const Motion motion;  // of the default motor: a microstep is 0.45 degrees
  for (const int snapshots : {8, 12, 36, 100}) {
    const ScanSettings near{.snapshots = 400};
    const ScanSettings far{.snapshots = snapshots};
    const Seconds longer = estimate_scan({}, far).stop - estimate_scan({}, near).stop;
    const double turn = move_time(motion, motion.steps_per_turn / snapshots) -
                        move_time(motion, motion.steps_per_turn / 400);
    EXPECT_NEAR(longer.count(), turn, 0.03) << "of 0.025 s for a step at the start speed";
  }
}

TEST(ScanEstimate, IsAGuessWhereNoScanTellsIt) {
  ScanSettings other_filter = usual;
  other_filter.filter = DepthFilter::basic;
  EXPECT_FALSE(estimate_scan({}, usual).is_measured);
  EXPECT_GT(estimate_scan({}, usual).total(9), 5s);
  EXPECT_GT(estimate_scan({}, usual).bytes, 1'000'000U);
  EXPECT_FALSE(estimate_scan({earlier(other_filter, 25s, 5s)}, usual).is_measured);
  EarlierScan failed = earlier(usual, 25s, 5s);
  failed.job.state = JobState::failed;
  EXPECT_FALSE(estimate_scan({failed}, usual).is_measured);
}

}  // namespace
}  // namespace octurn
