#include "build/build_model.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <span>
#include <utility>

#include "calibration/solve_pose.hpp"
#include "capture/last_look.hpp"
#include "octurn/scan_folder.hpp"
#include "store/checked_snapshots.hpp"
#include "store/model_scan.hpp"
#include "store/stored_scan.hpp"

namespace octurn {
namespace {

using Clock = std::chrono::steady_clock;

/// Returns the model's clip box: that of the settings. If it is the scan's own box, a scan of
/// several poses has the box that encloses the clip boxes of all poses instead.
Box choose_clip(const Scan& scan, const BuildInput& input) {
  const Box& wanted = input.settings.scan.clip;
  const Box& own = input.job.settings.clip;
  const bool is_own = wanted.min == own.min && wanted.max == own.max;
  return is_own && !scan.poses.empty() ? model_clip(scan) : wanted;
}

std::vector<CalibrationFinding> calibration_findings(const Job& job) {
  return job.calibration ? job.calibration->findings : std::vector<CalibrationFinding>{};
}

/// Solves the sensor's pose if the settings ask for it and the scan has no solved pose.
/// @param[out] build  gets the calibration
/// @return the findings of the calibration; those of the scan's own if its solved pose is reused
std::vector<CalibrationFinding> solve(Scan& scan, Build& build, const BuildInput& input,
                                      int threads, const std::stop_token& stop,
                                      const BuildProgress& progress) {
  if (scan.solved) {
    return calibration_findings(input.job);
  }
  if (input.settings.scan.pose != PoseSource::solved || !is_one_turn(scan)) {
    return {};
  }
  progress(Phase::calibrating, 0);
  const ScanSolution solution =
      solve_scan(input.folder, scan, readable_snapshots(input.folder, scan, stop), threads, stop);
  throw_if_stopped(stop);
  build.calibration = to_scan_calibration(solution.report);
  take_solution(scan, solution);
  return solution.report.findings;
}

/// Wraps a source: reports the number of snapshots read so far to `progress`.
SnapshotSource counted(SnapshotSource snapshots, const BuildProgress& progress) {
  const auto done = std::make_shared<std::atomic<int>>(0);
  const auto count = static_cast<int>(snapshots.count);
  return {.count = snapshots.count,
          .read = [done, count, progress, read = std::move(snapshots.read)](std::size_t shot) {
            Snapshot snapshot = read(shot);
            progress(Phase::rebuilding, std::min(++*done, count));
            return snapshot;
          }};
}

}  // namespace

std::vector<CalibrationFinding> scan_findings(const Job& job, const std::filesystem::path& folder) {
  auto findings = calibration_findings(job);
  add_stored_move(folder, findings);
  return findings;
}

std::optional<Build> build_model(const BuildInput& input, const Limits& limits,
                                 const std::filesystem::path& file, const std::stop_token& stop,
                                 const BuildProgress& progress) try {
  const Clock::time_point begin = Clock::now();
  const BuildSettings& settings = input.settings;
  Build build{.settings = settings};
  Scan scan = scan_to_build(input.folder, settings);
  const auto all = static_cast<int>(scan.shots.size());
  auto findings = input.findings;
  if (!findings) {
    findings = solve(scan, build, input, limits.threads, stop, progress);
    add_stored_move(input.folder, *findings);
  }

  ReconstructOptions options = checked_options(settings.scan, limits, scan.shots.size());
  options.level = settings.level;
  options.clip = choose_clip(scan, input);
  options.placements = placements(scan);
  fit_to_sensor(options, scan);
  PoseChecks checks(options.placements, options.clip, scan.shots.size());
  const SnapshotSource stored = readable_snapshots(input.folder, scan, stop);
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  progress(Phase::rebuilding, 0);
  reconstruction->add(counted(checked_snapshots(stored, checks), progress), stop);
  progress(Phase::building, all);
  auto report = write_model(*reconstruction, stored, file, stop);
  if (!report) {
    return std::nullopt;
  }
  Quality quality = judge(checks.figures(limits.threads), *report, *findings);
  const auto& calibration = build.calibration ? build.calibration : input.job.calibration;
  quality.size_error = expected_size_error(
      scan, report->size, calibration ? calibration->optics : std::optional<SolvedOptics>());
  report->places = {};  // dropped: every request for a job's state copies it
  build.model = {.report = *std::move(report),
                 .build_time = Clock::now() - begin,
                 .quality = std::move(quality)};
  return build;
} catch (const Stopped&) {
  return std::nullopt;
}

}  // namespace octurn
