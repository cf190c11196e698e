#include "calibration/solve_pose.hpp"

#include <utility>
#include <vector>

#include "octurn/error.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double max_sigmas = 3;  // maximum distance of a turn from the mean

/// A rotation vector and a shift.
struct SmallMotion {
  Vector3d rotation = Vector3d::Zero();  // radians
  Vector3d shift = Vector3d::Zero();     // metres
};

SmallMotion motion_between(const Isometry3d& from, const Isometry3d& to) {
  const Isometry3d between = to * from.inverse();
  const Eigen::AngleAxisd turn(between.linear());
  return {.rotation = turn.angle() * turn.axis(), .shift = between.translation()};
}

Isometry3d moved(const Isometry3d& pose, const SmallMotion& motion) {
  const double angle = motion.rotation.norm();
  Isometry3d by = Isometry3d::Identity();
  if (angle > 0) {
    by.linear() = Eigen::AngleAxisd(angle, motion.rotation / angle).toRotationMatrix();
  }
  by.translation() = motion.shift;
  return by * pose;
}

}  // namespace

CalibrationReport solve_pose(const Scan& scan, const SnapshotSource& snapshots, int threads) {
  if (!is_one_turn(scan)) {
    throw Error(ErrorCode::scan_malformed,
                "the scan is of several poses, and a pose is solved from one turn",
                "Solve each turn before they are merged.");
  }
  Scan configured = scan;
  configured.solved.reset();
  CalibrationTurn turn{.intrinsics = model_intrinsics(configured, configured.shots.front()),
                       .platform_from_sensor = scan.platform_from_sensor,
                       .angles = {},
                       .has_sensor_map = scan.sensor_map != nullptr,
                       .optics = scan.optics,
                       .read = {}};
  for (const Shot& shot : scan.shots) {
    turn.angles.push_back(shot.angle);
  }
  turn.read = [&snapshots](std::size_t stop) { return snapshots.read(stop).frame; };
  return calibrate(turn, threads);
}

SolvedPose to_solved_pose(const CalibrationReport& report) {
  return {.platform_from_sensor = report.platform_from_sensor,
          .position_sigma = report.position_sigma,
          .direction_sigma = report.direction_sigma,
          .before = report.before,
          .after = report.after,
          .optics = report.optics_differ ? report.optics : std::nullopt};
}

ScanCalibration to_scan_calibration(const CalibrationReport& report) {
  return {.accepted = report.accepted,
          .confirms_told = report.confirms_told(),
          .reason = report.reason,
          .solved = report.accepted ? std::optional(to_solved_pose(report)) : std::nullopt,
          .optics = report.optics,
          .findings = report.findings};
}

ScanSolution solve_scan(const std::filesystem::path& folder, const Scan& scan,
                        const SnapshotSource& snapshots, int threads, const std::stop_token& stop) {
  const LaserCalibration found =
      scan.laser ? calibrate_lasers(folder, scan, threads, stop)
                 : LaserCalibration{.report = solve_pose(scan, snapshots, threads)};
  CalibrationReport report = found.report;
  if (scan.laser) {  // a share of the stops has depth images: the lines stay at the configured
                     // angles
    report.slipped.clear();
  }
  ScanSolution solution{
      .report = report,
      .solved = to_solved_pose(report),
      .replaces_told = report.accepted && (found.moved_a_plane || !report.confirms_told())};
  solution.solved.lasers = found.lasers;
  return solution;
}

bool take_solution(Scan& scan, const ScanSolution& solution) {
  if (!solution.replaces_told) {
    return false;
  }
  scan.solved = solution.solved;
  const std::vector<double>& slipped = solution.report.slipped;
  for (std::size_t stop = 0; stop < scan.shots.size(); ++stop) {
    scan.shots[stop].slipped = stop < slipped.size() ? slipped[stop] : 0;
  }
  return true;
}

std::optional<Isometry3d> shared_pose(std::span<const SolvedPose> turns) {
  if (turns.size() < 2) {
    return std::nullopt;
  }
  const Isometry3d& first = turns.front().platform_from_sensor;
  SmallMotion mean;
  double rotation_weight = 0;
  double shift_weight = 0;
  for (const SolvedPose& turn : turns) {
    const SmallMotion motion = motion_between(first, turn.platform_from_sensor);
    const double of_rotation = 1 / (turn.direction_sigma * turn.direction_sigma);
    const double of_shift = 1 / (turn.position_sigma * turn.position_sigma);
    mean.rotation += of_rotation * motion.rotation;
    mean.shift += of_shift * motion.shift;
    rotation_weight += of_rotation;
    shift_weight += of_shift;
  }
  mean.rotation /= rotation_weight;
  mean.shift /= shift_weight;
  const Isometry3d pose = moved(first, mean);
  for (const SolvedPose& turn : turns) {
    const SmallMotion off = motion_between(pose, turn.platform_from_sensor);
    if (!(off.rotation.norm() <= max_sigmas * turn.direction_sigma &&
          off.shift.norm() <= max_sigmas * turn.position_sigma)) {
      return std::nullopt;
    }
  }
  return pose;
}

}  // namespace octurn
