#include <gtest/gtest.h>

#include <vector>

#include "run/run_scan.hpp"

namespace octurn {
namespace {

/// The stops of a turn at which the pose is solved, if every solution is refused.
std::vector<int> refused(PreviewSolves& solves, int snapshots) {
  std::vector<int> at;
  for (int done = 1; done <= snapshots; ++done) {
    if (solves.are_due(done)) {
      at.push_back(done);
      solves.take(done);
    }
  }
  return at;
}

TEST(PreviewSolves, TriesARefusedPoseAgainAfterAHalfAndTwoThirdsOfTheTurn) {
  PreviewSolves solves(36);
  EXPECT_EQ(refused(solves, 36), (std::vector<int>{12, 18, 24}));
}

TEST(PreviewSolves, SolvesAFewStopsOnceForAllSharesThatTheyHavePassed) {
  PreviewSolves nine(9);
  EXPECT_EQ(refused(nine, 9), (std::vector<int>{6}));
  PreviewSolves ten(10);
  EXPECT_EQ(refused(ten, 10), (std::vector<int>{6, 7}));
  PreviewSolves six(6);
  EXPECT_EQ(refused(six, 6), std::vector<int>{}) << "the model follows";
}

TEST(PreviewSolves, EndsWithAnAcceptedPose) {
  PreviewSolves solves(36);
  EXPECT_FALSE(solves.are_due(11));
  EXPECT_TRUE(solves.are_due(12));
  solves.take(12);
  solves.end();
  for (int done = 13; done < 36; ++done) {
    EXPECT_FALSE(solves.are_due(done)) << done;
  }
}

TEST(PreviewSolves, WaitsForAStopAfterEachAttemptOfAResumedScan) {
  PreviewSolves solves(36);
  solves.resume_after(30);
  EXPECT_FALSE(solves.are_due(30));
  EXPECT_EQ(refused(solves, 36), (std::vector<int>{31}));
}

}  // namespace
}  // namespace octurn
