#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "calibrate/stop_offsets.hpp"
#include "calibrate/turn_ratio.hpp"
#include "io/number_text.hpp"
#include "laser/line_strip.hpp"
#include "laser/rig_solver.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/median.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

// Priors of three hypotheses on how a rig went out of adjustment: a laser was turned in its holder,
// mostly about the vertical; the camera was moved with its lasers; or both. The third is tried only
// if neither of the others explains the measurements.
const RigTrust trusted_pose{.pose_shift = 0.0002,
                            .pose_turn = radians_from_degrees(0.02),
                            .plane_shift = 0.003,
                            .plane_turn = radians_from_degrees(0.5),
                            .plane_tilt = radians_from_degrees(0.02)};
const RigTrust trusted_planes{.pose_shift = 0.02,
                              .pose_turn = radians_from_degrees(3),
                              .plane_shift = 0.00005,
                              .plane_turn = radians_from_degrees(0.01),
                              .plane_tilt = radians_from_degrees(0.01)};
const RigTrust trusted_in_part{.pose_shift = 0.005,
                               .pose_turn = radians_from_degrees(1),
                               .plane_shift = 0.0005,
                               .plane_turn = radians_from_degrees(0.1),
                               .plane_tilt = radians_from_degrees(0.1)};
constexpr double max_cost_ratio_planes = 0.95;   // from which `trusted_planes` is chosen
constexpr double max_cost_ratio_in_part = 0.85;  // the same for `trusted_in_part`

constexpr std::size_t min_platform_points = 500;
constexpr std::size_t min_pairs = 500;

// Largest medians of the lines' heights on the platform and of the distances between two lasers,
// metres. A coarse camera is allowed half a pixel at the object.
constexpr double max_height = 0.0003;
constexpr double max_disagreement = 0.0004;
constexpr double max_pixels = 0.5;
constexpr double max_shift = 0.04;  // metres
constexpr double max_turn_deg = 6;
constexpr double min_slip_deg = 0.3;
constexpr double settled_slip_deg = 0.02;
// Measured: 0.3 to 0.7 with a slip, 0.01 to 0.08 without one.
constexpr double min_explained_by_slip = 0.2;
constexpr double lever = 0.05;  // metres above the platform, where `position_sigma` holds

// The configured rig is kept if a solution changes the fit by no more than this share. Two lasers
// of a correct rig disagree by 0.1 mm; a plane that is off by `least_turn_deg`, 0.03 mm at the
// object, adds a twentieth to that, as much as noise does from turn to turn.
constexpr double negligible_share = 0.05;

// Smallest change of a plane that is worth a new model.
constexpr double least_shift = 0.00005;  // metres
constexpr double least_turn_deg = 0.004;

/// The median distance between the surfaces of two lasers, metres; without an object, of the lines
/// on the platform from its plane.
double disagreement(const RigSolution& solution) {
  return solution.surface_distances.size() >= min_pairs ? median(solution.surface_distances)
                                                        : median(solution.platform_heights);
}

/// Whether a solution fits no better than the configured rig: its disagreement is the same within
/// `negligible_share`, and the platform's lines are not flatter by more.
bool fits_no_better(const RigSolution& solution, const RigSolution& configured) {
  const double before = disagreement(configured);
  return std::abs(disagreement(solution) - before) <= negligible_share * before &&
         median(solution.platform_heights) >=
             (1 - negligible_share) * median(configured.platform_heights);
}

RigSolution solve_best(const RigSolver& solver) {
  RigSolution best = solver.solve(trusted_pose);
  RigSolution other = solver.solve(trusted_planes);
  if (other.cost < max_cost_ratio_planes * best.cost) {
    best = std::move(other);
  }
  if (disagreement(best) > max_disagreement / 4 || median(best.platform_heights) > max_height / 3) {
    other = solver.solve(trusted_in_part);
    if (other.cost < max_cost_ratio_in_part * best.cost) {
      best = std::move(other);
    }
  }
  return best;
}

/// Finds where the platform slipped, and solves the rig with the angles at which it stood.
/// @param best     solved with the configured angles
/// @param slipped  radians at each stop, all 0; set
RigSolution solve_slips(RigSolver& solver, RigSolution best, std::vector<double>& slipped) {
  constexpr int most_slips = 8;
  constexpr int passes = 10;  // as a point's nearest neighbours are others once it has moved
  for (int slips = 0; slips < most_slips; ++slips) {
    std::optional<Slip> slip = solver.find_slip(best.rig);
    if (!slip || std::abs(slip->angle) < radians_from_degrees(min_slip_deg) ||
        slip->explained < min_explained_by_slip) {
      break;
    }
    for (int pass = 0; slip && pass < passes; ++pass) {
      for (std::size_t stop = slip->stop; stop < slipped.size(); ++stop) {
        slipped[stop] += slip->angle;
      }
      solver.set_slipped(slipped);
      if (std::abs(slip->angle) < radians_from_degrees(settled_slip_deg)) {
        break;
      }
      best = solve_best(solver);
      slip = solver.find_slip(best.rig, slip->stop);
    }
  }
  return best;
}

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Sets the shift, lift and tilt of the axis from the configured pose to the solved one.
void compare_poses(const Eigen::Isometry3d& configured, CalibrationReport& report) {
  const Eigen::Isometry3d change = report.platform_from_sensor * configured.inverse();
  const Vector3d origin = change.inverse() * Vector3d::Zero();
  report.shift = origin.head<2>().norm();
  report.lift = origin.z();
  report.tilt = angle_between(change.linear() * Vector3d::UnitZ(), Vector3d::UnitZ());
}

void set_sigmas(const RigSolution& solution, CalibrationReport& report) {
  const Eigen::MatrixXd& spread = solution.covariance;
  report.direction_sigma = std::sqrt(std::max(spread(0, 0), spread(1, 1)));
  report.position_sigma = std::sqrt(std::max(spread(2, 2) + lever * lever * spread(1, 1),
                                             spread(3, 3) + lever * lever * spread(0, 0)));
}

bool moved_a_plane(const std::vector<Laser>& configured, const std::vector<Laser>& solved) {
  for (std::size_t i = 0; i < configured.size(); ++i) {
    const double turn = angle_between(configured[i].normal, solved[i].normal);
    // The plane's distance from the camera: it changes by as much as the plane moves at the object.
    const double shift = std::abs(configured[i].distance - solved[i].distance);
    if (turn > radians_from_degrees(least_turn_deg) || shift > least_shift) {
      return true;
    }
  }
  return false;
}

/// What a solution may leave, metres.
struct Limits {
  double height = 0;
  double disagreement = 0;

  /// @param pixel  width of a pixel at the object, metres
  explicit Limits(double pixel)
      : height(std::max(max_height, max_pixels * pixel)),
        disagreement(std::max(max_disagreement, max_pixels * pixel)) {}
};

/// Two lasers see other surfaces of an object: what a turntable that lost steps looks like, too.
CalibrationFinding describe_disagreement(double between_lasers) {
  return {
      .code = "stops-disagree",
      .detail = "two lasers disagree about the object by " + mm_text(between_lasers, 2) +
                ": the motor lost steps, or the object, the camera or a laser moved",
      .hint = "Look whether object, camera and lasers stand firm. If they do, turn more slowly.",
      .stop = {},
      .angle = {},
      .parameters = {{"lasers_mm", mm_from_metres(between_lasers)}}};
}

bool lasers_disagree(const RigSolution& solution, const Limits& limits) {
  return solution.surface_distances.size() >= min_pairs &&
         disagreement(solution) > limits.disagreement;
}

/// Returns the finding of a platform that turned the other way.
/// @param rig  as solved with the configured angles
std::optional<CalibrationFinding> find_turn(const RigSolver& solver, const LaserRig& rig,
                                            std::size_t stops) {
  constexpr double min_confirmed = 0.5;    // of the points, by the reversed angles
  constexpr double distinguishable = 0.7;  // of these, by the configured angles
  if (rig.lasers.size() < 2) {
    return std::nullopt;  // no place is seen at two stops
  }
  const double as_told = solver.confirmed_share(rig, 1);
  const double reversed = solver.confirmed_share(rig, -1);
  return reversed > std::max(min_confirmed, as_told / distinguishable)
             ? find_wrong_turn({.ratio = -1, .confirmed = reversed, .as_told = as_told}, stops)
             : std::nullopt;
}

/// Returns the finding of two lasers that are wired to each other's lines: each with the other's
/// plane, they fit.
std::optional<CalibrationFinding> find_exchange(const LaserLines& lines, LaserRig rig,
                                                const Limits& limits, int threads,
                                                const std::stop_token& stop) {
  if (rig.lasers.size() != 2) {
    return std::nullopt;
  }
  std::swap(rig.lasers[0].normal, rig.lasers[1].normal);
  std::swap(rig.lasers[0].distance, rig.lasers[1].distance);
  const RigSolver solver(lines, rig, threads, stop);
  if (solver.platform_points() < min_platform_points) {
    return std::nullopt;
  }
  const RigSolution best = solve_best(solver);
  if (median(best.platform_heights) > limits.height || lasers_disagree(best, limits)) {
    return std::nullopt;
  }
  return CalibrationFinding{
      .code = "lasers-exchanged",
      .detail = "the lasers are exchanged: each line lies in the plane of the other laser",
      .hint = "Exchange the lasers' GPIO lines in the settings, or their wires."};
}

/// Returns why a solution is refused; empty if it is accepted.
std::string refusal(const RigSolution& solution, const CalibrationReport& report,
                    const std::vector<Laser>& configured, const Limits& limits) {
  if (median(solution.platform_heights) > limits.height) {
    return "the lines on the platform are " + mm_text(median(solution.platform_heights), 2) +
           " from flat";
  }
  if (lasers_disagree(solution, limits)) {
    return describe_disagreement(disagreement(solution)).detail;
  }
  if (report.after > report.before) {
    return "the configured pose and planes fit better than the solved ones";
  }
  const bool far_turned = std::ranges::any_of(solution.rig.lasers, [&](const Laser& laser) {
    const auto was = std::ranges::find(configured, laser.name, &Laser::name);
    return angle_between(was->normal, laser.normal) > radians_from_degrees(max_turn_deg);
  });
  if (report.shift > max_shift || report.tilt > radians_from_degrees(max_turn_deg) || far_turned) {
    return "the solved rig is too far from the configured one";
  }
  return "";
}

/// Gives the report a fault, if one was found, as its finding and its reason.
void name_fault(CalibrationReport& report, std::optional<CalibrationFinding> fault) {
  if (fault) {
    report.reason = fault->detail;
    report.findings.push_back(*std::move(fault));
  }
}

/// The step between the stops that are read: at most 100 of them, evenly spaced over the turn. More
/// hardly improve the fit, and reading a stop takes as long as reading it for the model.
std::size_t step_between(const Scan& scan) {
  constexpr std::size_t most_stops = 100;
  return (scan.shots.size() + most_stops - 1) / most_stops;
}

/// Reports where the platform slipped.
/// @param slipped  radians, at each of the stops that were read
void add_slips(CalibrationReport& report, const std::vector<double>& slipped, std::size_t step,
               std::size_t stops) {
  for (std::size_t stop = 0; stop < stops; ++stop) {
    report.slipped.push_back(slipped[stop / step]);
    const double slip = stop == 0 ? 0 : report.slipped[stop] - report.slipped[stop - 1];
    if (slip != 0) {
      report.findings.push_back(describe_slip(static_cast<int>(stop), slip));
    }
  }
}

/// Returns the scan with some of its stops.
/// @param step  from one of these stops to the next
Scan thinned(const Scan& scan, std::size_t step) {
  Scan some = scan;
  some.shots.clear();
  for (std::size_t stop = 0; stop < scan.shots.size(); stop += step) {
    some.shots.push_back(scan.shots[stop]);
  }
  return some;
}

}  // namespace

LaserCalibration calibrate_lasers(const std::filesystem::path& folder, const Scan& scan,
                                  int threads, const std::stop_token& stop) {
  if (!scan.laser || !is_one_turn(scan)) {
    throw Error(ErrorCode::scan_malformed, "lasers are calibrated from one turn by laser line");
  }
  throw_if_stopped(stop);
  const LaserRig configured{.platform_from_sensor = scan.platform_from_sensor,
                            .lasers = scan.laser->lasers};
  const std::size_t step = step_between(scan);
  const LaserLines lines(folder, thinned(scan, step));
  RigSolver solver(lines, configured, threads, stop);
  LaserCalibration calibration{.lasers = configured.lasers};
  CalibrationReport& report = calibration.report;
  report.platform_from_sensor = configured.platform_from_sensor;
  const Limits limits(lines.pixel());
  const auto exchange = [&] { return find_exchange(lines, configured, limits, threads, stop); };
  if (solver.platform_points() < min_platform_points) {
    report.reason = "the lasers' lines are not seen on the platform";
    name_fault(report, exchange());
    return calibration;
  }
  const RigSolution as_told = solver.as_told();
  report.before = disagreement(as_told);
  std::vector<double> slipped(lines.scan().shots.size(), 0.0);
  RigSolution best = solve_slips(solver, solve_best(solver), slipped);
  report.after = disagreement(best);
  if (fits_no_better(best, as_told)) {
    best.rig = configured;
    report.after = report.before;
  }
  report.platform_from_sensor = best.rig.platform_from_sensor;
  compare_poses(configured.platform_from_sensor, report);
  set_sigmas(best, report);
  report.reason = refusal(best, report, configured.lasers, limits);
  const bool is_told_wrong =
      lasers_disagree(best, limits) || best.surface_distances.size() < min_pairs;
  if (is_told_wrong) {
    name_fault(report, find_turn(solver, best.rig, scan.shots.size()));
  }
  if (!report.reason.empty() && report.findings.empty()) {
    name_fault(report, exchange());
  }
  if (lasers_disagree(best, limits) && report.findings.empty()) {
    report.findings.push_back(describe_disagreement(disagreement(best)));
  }
  report.accepted = report.reason.empty();
  if (report.accepted) {
    add_slips(report, slipped, step, scan.shots.size());
  }
  calibration.lasers = best.rig.lasers;
  for (Laser& laser : calibration.lasers) {
    laser.source.reset();
  }
  calibration.moved_a_plane = report.accepted && moved_a_plane(configured.lasers, best.rig.lasers);
  return calibration;
}

}  // namespace octurn
