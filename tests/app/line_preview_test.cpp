// The preview of a scan by laser line while its platform turns.

#include "capture/line_preview.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "app/simulated_laser_rig.hpp"
#include "octurn/scan_folder.hpp"
#include "run/run_scan.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

ScanSettings preview_settings(int stops) {
  ScanSettings few;
  use_laser_capture_defaults(few);
  few.snapshots = stops;
  few.leaf_size = 0.002;
  few.pose = PoseSource::configured;
  return few;
}

std::vector<Facet> preview_of(const Reconstructor& reconstruction) {
  std::vector<Facet> facets;
  reconstruction.preview(
      0.002, 60'000,
      [&](std::span<const Facet> some) { facets.insert(facets.end(), some.begin(), some.end()); },
      {});
  return facets;
}

/// Counts the sectors around the axis, of 36, that have a facet.
int parts_with_facets(const std::vector<Facet>& facets) {
  std::vector<bool> seen(36);
  for (const Facet& facet : facets) {
    const double angle = std::atan2(static_cast<double>(facet.corners[0][1]),
                                    static_cast<double>(facet.corners[0][0])) /
                             (2 * std::acos(-1.0)) +
                         0.5;
    seen[std::min<std::size_t>(35, static_cast<std::size_t>(36 * angle))] = true;
  }
  return static_cast<int>(std::ranges::count(seen, true));
}

/// Scans a simulated object and records its previews.
class LinePreviewOfAScan : public ::testing::Test {
 protected:
  /// One preview: the number of stops in it, and of the sectors with a facet.
  struct Shown {
    int stops = 0;
    int parts = 0;
  };

  std::vector<Shown> scan(int stops) {
    std::vector<Shown> shown;
    Rig rig(simulated_.options(20));
    const ScanObserver observer{.on_added = [&](const Reconstructor& reconstruction, int done) {
      shown.push_back({.stops = done, .parts = parts_with_facets(preview_of(reconstruction))});
    }};
    EXPECT_TRUE(
        run_scan(preview_settings(stops), {}, folder_.path(), *make_capture(rig), {}, observer));
    return shown;
  }

  TemporaryFolder folder_ = {};
  SimulatedLaserRig simulated_ = SimulatedLaserRig();
};

TEST_F(LinePreviewOfAScan, GrowsRoundTheObjectWhileThePlatformTurns) {
  const std::vector<Shown> shown = scan(24);
  ASSERT_FALSE(shown.empty());
  EXPECT_LT(shown.front().stops, 24);
  EXPECT_GT(shown.back().parts, 18);
  EXPECT_TRUE(std::ranges::is_sorted(shown, {}, &Shown::stops));
}

TEST_F(LinePreviewOfAScan, LeavesTheModelAsItIsMadeFromTheFolder) {
  scan(12);
  const Scan stored = read_scan(folder_.path());
  ReconstructOptions options = reconstruct_options(preview_settings(12), {.threads = 1});
  options.clip = stored.clip;
  fit_to_scan(options, stored);
  const SnapshotSource snapshots = stored_snapshots(folder_.path(), stored);
  const std::unique_ptr<Reconstructor> again = make_reconstructor(options);
  again->add(snapshots);
  write_model(*again, snapshots, folder_.path() / "again.stl", {});
  EXPECT_TRUE(content_of(folder_.path() / "Scan.stl") == content_of(folder_.path() / "again.stl"));
}

// That includes lines taken while the preview was busy, or before the scan was interrupted.
TEST_F(LinePreviewOfAScan, AddsEachLineOnce) {
  scan(12);
  const Scan stored = read_scan(folder_.path());
  ReconstructOptions options = reconstruct_options(preview_settings(12), {.threads = 1});
  options.clip = stored.clip;
  fit_to_scan(options, stored);
  const auto last_seen = [&](const std::vector<std::size_t>& asked) {
    std::vector<Facet> last;
    const ScanObserver observer{.on_added = [&](const Reconstructor& reconstruction, int) {
      last = preview_of(reconstruction);
    }};
    LinePreview preview(folder_.path(), options, 12, {}, observer);
    for (const std::size_t stops : asked) {
      Scan so_far = stored;
      so_far.shots.resize(stops);
      preview.add(so_far);
      preview.wait();
    }
    return last.size();
  };
  EXPECT_EQ(last_seen({12}), last_seen({1, 2, 3, 3, 7, 12, 12}));
  EXPECT_GT(last_seen({12}), last_seen({6}));
}

}  // namespace
}  // namespace octurn
