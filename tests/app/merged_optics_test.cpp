// Turns of one sensor whose optics became known, or whose scale was measured, in between.

#include <gtest/gtest.h>

#include <vector>

#include "build/merged_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

constexpr double unit = 0.0001;
constexpr double known_length = 1.02;

/// A scan of one stop, without its depth image.
Scan scan_with(double depth_unit, const std::optional<SensorOptics>& optics) {
  Scan scan{.intrinsics = {.depth_unit = depth_unit},
            .clip = {.min = {-0.1, -0.1, 0}, .max = {0.1, 0.1, 0.2}},
            .shots = {{.file = "snapshots/000.png"}}};
  if (optics) {
    scan.optics = SolvedOptics{.value = *optics, .sigma = {.fx = 1}};
  }
  return scan;
}

Scan scan_without_optics() { return scan_with(unit * known_length, {}); }

Scan scan_with_optics() {
  return scan_with(unit, SensorOptics{.fx = 590, .fy = 590, .depth_scale = known_length});
}

class MergedOptics : public ::testing::Test {
 protected:
  std::filesystem::path store(const char* name, const Scan& scan) {
    std::filesystem::path folder = folder_.path() / name;
    std::filesystem::create_directories(folder / "snapshots");
    put(folder / "snapshots/000.png", "a depth image");
    write_scan(folder, scan);
    return folder;
  }

  /// The intrinsics with which the merged scan's snapshots are read.
  std::vector<Intrinsics> merge(const Scan& first, const Scan& second) {
    const std::vector<StoredTurn> turns =
        read_turns({store("first", first), store("second", second)});
    write_merged_scan(folder_.path() / "merged", turns, {.poses = {{}, {}}});
    const Scan merged = read_scan(folder_.path() / "merged");
    std::vector<Intrinsics> all;
    for (const Shot& shot : merged.shots) {
      all.push_back(model_intrinsics(merged, shot));
    }
    return all;
  }

  TemporaryFolder folder_;
};

TEST_F(MergedOptics, OfTurnsBeforeAndAfterTheyWereKnownHaveTheScaleOnce) {
  const std::vector<Intrinsics> all = merge(scan_without_optics(), scan_with_optics());
  ASSERT_EQ(all.size(), 2U);
  EXPECT_DOUBLE_EQ(all[0].depth_unit, unit * known_length);
  EXPECT_EQ(all[0].fx, Intrinsics().fx);
  EXPECT_DOUBLE_EQ(all[1].depth_unit, unit * known_length);
  EXPECT_EQ(all[1].fx, 590);
}

TEST_F(MergedOptics, OfTurnsAfterAndBeforeTheyWereKnownHaveTheScaleOnce) {
  const std::vector<Intrinsics> all = merge(scan_with_optics(), scan_without_optics());
  ASSERT_EQ(all.size(), 2U);
  EXPECT_DOUBLE_EQ(all[0].depth_unit, unit * known_length);
  EXPECT_DOUBLE_EQ(all[1].depth_unit, unit * known_length);
  EXPECT_EQ(all[1].fx, Intrinsics().fx);
}

TEST_F(MergedOptics, ThatATurnSolvedItselfStayInItsOwnUnit) {
  Scan solved = scan_without_optics();
  solved.solved = SolvedPose{.optics = SolvedOptics{.value = {.fx = 589}}};
  const std::vector<Intrinsics> all = merge(scan_with_optics(), solved);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[1].fx, 589);
  EXPECT_DOUBLE_EQ(all[1].depth_unit, unit * known_length);
}

TEST_F(MergedOptics, AreOfOneSensor) {
  EXPECT_EQ(code_thrown_by([&] { merge(scan_without_optics(), scan_with(10 * unit, {})); }),
            "scan-malformed");
}

}  // namespace
}  // namespace octurn
