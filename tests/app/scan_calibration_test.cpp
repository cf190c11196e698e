// A scan that solves the sensor's pose from its own snapshots.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "app/few_snapshots.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"
#include "rig/nominal_pose.hpp"
#include "run/run_scan.hpp"
#include "store/stored_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/wrong_pose.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// The distance between the platform's origins of two poses, in the sensor's frame, millimetres.
double origins_apart_mm(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return mm_from_metres((a.inverse().translation() - b.inverse().translation()).norm());
}

class ScanCalibrationTest : public ::testing::Test {
 protected:
  static ScanSettings told(const Eigen::Isometry3d& pose) {
    ScanSettings settings = few_snapshots(12);
    settings.platform_from_sensor = pose;
    return settings;
  }

  /// Runs a scan to its end. @return its phases, without repetitions
  std::vector<Phase> scan(const ScanSettings& settings, const fs::path& folder) {
    Rig rig({.sensor_uri = "octurn-simulator://?speed=50", .speed = 50});
    std::vector<Phase> phases;
    const ScanObserver observer{
        .on_progress =
            [&](Phase phase, int /*done*/) {
              if (phases.empty() || phases.back() != phase) {
                phases.push_back(phase);
              }
            },
        .on_added =
            [&](const Reconstructor& reconstruction, int snapshots) {
              previews_[snapshots].clear();
              reconstruction.preview(0.004, 20'000, [&](std::span<const Facet> facets) {
                previews_[snapshots].insert(previews_[snapshots].end(), facets.begin(),
                                            facets.end());
              });
            },
        .on_calibrated = [&](const ScanSolution& solution) { report_ = solution.report; },
        .on_rebuilt = [&](int snapshots) { rebuilt_.push_back(snapshots); }};
    report_.reset();
    EXPECT_TRUE(run_scan(settings, {}, folder, *make_capture(rig), {}, observer));
    return phases;
  }

  /// The model of a stored scan, made from its folder alone.
  static std::string model_of(const fs::path& folder, const ScanSettings& settings) {
    const Scan scan = read_scan(folder);
    const SnapshotSource snapshots = stored_snapshots(folder, scan);
    const auto reconstruction = make_reconstructor(reconstruct_options(settings, {.threads = 1}));
    reconstruction->add(snapshots);
    const TemporaryFolder other;
    write_model(*reconstruction, snapshots, other.path() / "Scan.stl", {});
    return content_of(other.path() / "Scan.stl");
  }

  TemporaryFolder folder_;
  std::optional<CalibrationReport> report_;
  std::vector<int> rebuilt_;
  std::map<int, std::vector<Facet>> previews_;  // by the number of snapshots
};

/// The share of a model's corners that have one of a preview within two of its leaves.
double shown_share(const fs::path& model, const std::vector<Facet>& preview) {
  constexpr float near_mm = 8;
  int all = 0;
  int shown = 0;
  FacetFile(model).read([&](std::span<const Facet> facets) {
    for (const Facet& facet : facets) {
      const Eigen::Vector3f corner(facet.corners[0].data());
      ++all;
      shown += std::ranges::any_of(
                   preview,
                   [&](const Facet& seen) {
                     return (Eigen::Vector3f(seen.corners[0].data()) - corner).norm() < near_mm;
                   })
                   ? 1
                   : 0;
    }
  });
  return static_cast<double>(shown) / all;
}

TEST_F(ScanCalibrationTest, BuildsTheModelAgainWhereTheToldPoseIsWrong) {
  const ScanSettings settings = told(wrong_pose());
  const std::vector<Phase> phases = scan(settings, folder_.path());
  ASSERT_GE(phases.size(), 3U);
  EXPECT_EQ(std::vector<Phase>(phases.end() - 3, phases.end()),
            (std::vector<Phase>{Phase::calibrating, Phase::rebuilding, Phase::building}));
  ASSERT_TRUE(report_ && report_->accepted) << report_->reason;

  const Scan stored = read_scan(folder_.path());
  ASSERT_TRUE(stored.solved);
  EXPECT_TRUE(stored.platform_from_sensor.isApprox(wrong_pose(), 1e-12));
  // 1.5 mm is a tenth of the initial error, and twice the bias of the axis from the simulated
  // sensor's pattern.
  const Eigen::Isometry3d truth = misaligned_platform_from_sensor(1);
  EXPECT_LT(origins_apart_mm(stored.solved->platform_from_sensor, truth), 1.5);
  EXPECT_GT(origins_apart_mm(wrong_pose(), truth), 15.0);
  EXPECT_TRUE(content_of(folder_.path() / "Scan.stl") == model_of(folder_.path(), settings));
}

TEST_F(ScanCalibrationTest, KeepsAPoseThatAnEarlierScanHasSolved) {
  const TemporaryFolder first;
  scan(told(wrong_pose()), first.path());
  const ScanSettings settings = told(model_pose(read_scan(first.path())));

  const std::vector<Phase> phases = scan(settings, folder_.path());
  EXPECT_EQ(std::vector<Phase>(phases.end() - 2, phases.end()),
            (std::vector<Phase>{Phase::calibrating, Phase::building}));
  ASSERT_TRUE(report_);
  EXPECT_TRUE(report_->confirms_told())
      << mm_from_metres(report_->shift) << " mm aside, " << mm_from_metres(report_->lift)
      << " mm up, with a sigma of " << mm_from_metres(report_->position_sigma) << " mm, "
      << degrees_from_radians(report_->tilt) << " degrees tilted, with a sigma of "
      << degrees_from_radians(report_->direction_sigma)
      << " degrees; other optics: " << report_->optics_differ << "; " << report_->accepted << ' '
      << report_->reason;
  EXPECT_FALSE(read_scan(folder_.path()).solved);
}

TEST_F(ScanCalibrationTest, SolvesNothingWhereThePoseIsTold) {
  ScanSettings settings = told(wrong_pose());
  settings.pose = PoseSource::configured;
  const std::vector<Phase> phases = scan(settings, folder_.path());
  EXPECT_EQ(std::ranges::count(phases, Phase::calibrating), 0);
  EXPECT_FALSE(report_);
  EXPECT_FALSE(read_scan(folder_.path()).solved);
}

TEST_F(ScanCalibrationTest, KeepsTheToldPoseWhereTheSolvedOneIsRefused) {
  ScanSettings settings = told(wrong_pose());
  settings.snapshots = 2;
  scan(settings, folder_.path());
  ASSERT_TRUE(report_);
  EXPECT_FALSE(report_->accepted);
  EXPECT_NE(report_->reason.find("too few stops"), std::string::npos) << report_->reason;
  EXPECT_FALSE(read_scan(folder_.path()).solved);
}

TEST_F(ScanCalibrationTest, ShowsAPreviewOfTheWholeObjectWhereTheToldPoseIsWrong) {
  scan(told(wrong_pose()), folder_.path());
  ASSERT_FALSE(previews_[11].empty());
  EXPECT_GT(shown_share(folder_.path() / "Scan.stl", previews_[11]), 0.95);
}

TEST_F(ScanCalibrationTest, CountsTheSnapshotsThatItBuildsAgain) {
  scan(told(wrong_pose()), folder_.path());
  ASSERT_FALSE(rebuilt_.empty());
  EXPECT_TRUE(std::ranges::is_sorted(rebuilt_));
  EXPECT_EQ(rebuilt_.back(), 12);
}

// Each folder is as a killed scan leaves it, and is resumed later.
TEST_F(ScanCalibrationTest, GivesTheSameModelWhereverItIsInterrupted) {
  const ScanSettings settings = told(wrong_pose());
  scan(settings, folder_.path());
  const std::string model = content_of(folder_.path() / "Scan.stl");
  const std::string solved = content_of(folder_.path() / "scan.json");
  nlohmann::json unsolved = nlohmann::json::parse(solved);
  unsolved["calibration"].erase("solved");

  for (const Phase moment : {Phase::calibrating, Phase::rebuilding, Phase::building}) {
    fs::remove(folder_.path() / "Scan.stl");
    put(folder_.path() / "scan.json", unsolved.dump());
    Rig rig({.sensor_uri = "octurn-simulator://?speed=50", .speed = 50});
    std::stop_source stop;
    const auto stop_there = [&](Phase phase, int /*done*/) {
      if (phase == moment) {
        stop.request_stop();
      }
    };
    EXPECT_FALSE(run_scan(settings, {}, folder_.path(), *make_capture(rig), stop.get_token(),
                          {.on_progress = stop_there}));
    EXPECT_FALSE(fs::exists(folder_.path() / "Scan.stl")) << to_string(moment);
    EXPECT_EQ(read_scan(folder_.path()).solved.has_value(), moment != Phase::calibrating);

    EXPECT_TRUE(run_scan(settings, {}, folder_.path(), *make_capture(rig), {}, {}));
    EXPECT_TRUE(content_of(folder_.path() / "Scan.stl") == model) << to_string(moment);
    EXPECT_EQ(content_of(folder_.path() / "scan.json"), solved);
  }
}

}  // namespace
}  // namespace octurn
