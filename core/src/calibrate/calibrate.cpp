#include "octurn/calibrate.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "calibrate/axis_solver.hpp"
#include "calibrate/optics_solver.hpp"
#include "calibrate/platform_plane.hpp"
#include "calibrate/read_turn.hpp"
#include "calibrate/stop_offsets.hpp"
#include "calibrate/stop_residuals.hpp"
#include "calibrate/stop_step.hpp"
#include "calibrate/surface_findings.hpp"
#include "calibrate/turn_ratio.hpp"
#include "io/number_text.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

// A solution beyond one of these limits is refused.
constexpr std::size_t min_pairs = 6;  // three, in both directions
constexpr std::size_t min_plane_inliers = 500;
constexpr double max_plane_rms = 0.0015;  // metres
constexpr double min_plane_share = 0.3;
constexpr double max_position_sigma = 0.0006;  // metres
// A larger sigma is accepted where the correction is large: a share of how far the pose moves.
constexpr double worthwhile_sigma = 0.05;
constexpr double worthwhile_direction_sigma = 0.2;  // a share of how far the axis tilts
constexpr double max_direction_sigma_deg = 0.2;     // 0.35 mm at a height of 100 mm
constexpr double max_after = 0.0012;  // metres; a Kinect at 0.65 m leaves 0.5 to 0.7 mm
// The median residual may grow by this factor: the solver minimises weighted squares instead.
constexpr double may_worsen = 1.02;
// With few stops each reading is compared with few others, and a pose that fits these may be worse
// for all else: it must also fit a stop that had no part in it.
constexpr std::size_t few_stops = 7;
// The share by which that stop's residuals must be smaller than with the configured pose, times the
// number of stops: half of them with four stops, a third with six.
constexpr double gain_times_stops = 2;
constexpr double max_shift = 0.040;  // metres
constexpr double max_tilt_deg = 6;
constexpr double max_last_step = 0.00001;  // metres
// Last steps below a tenth of the sigma count as converged: the nearest pixels keep changing.
constexpr double settled_sigmas = 0.1;
// Units of disparity. Noise leaves 0.03; of patterns of 0.8 the fitted plane leaves 0.25 to 0.74,
// and on tables that real sensors saw 0.27 to 0.82.
constexpr double max_unevenness = 0.2;

// Sigma of an even plane as a prior of the axis's direction, for a platform that is square to its
// shaft.
constexpr double tight_direction_deg = 0.02;
constexpr double unevenness_lever = 0.1;  // metres: what unevenness lifts there tilts the plane
constexpr double wobble_sigmas = 5;

constexpr double agreeing_shift = 0.0001;  // metres
constexpr double agreeing_tilt_deg = 0.05;
constexpr double agreeing_sigmas = 3;

// Mahalanobis distance, squared: beyond it the optics are applied.
constexpr double min_significance = 20;
// The same where the focal length alone is solved, of an uneven sensor without a map: two sigma.
constexpr double min_focal_significance = 4;
// No Kinect is known to be further off: the depth images are those of another sensor, or scaled.
constexpr double max_focal_error = 0.06;

constexpr int text_digits = 2;  // of millimetres and degrees

double mean_object_pixels(const TurnViews& views) {
  double pixels = 0;
  for (const ObjectView& view : views.views) {
    pixels += view.pixels();
  }
  return pixels / static_cast<double>(std::max<std::size_t>(views.views.size(), 1));
}

/// Radians: sigma of the plane as a prior of the axis's direction. An uneven surface may also tilt
/// the plane that is fitted to it. 1/z is (normal / offset) . ray on the plane: an inverse depth
/// that is off by d lifts it by d z offset.
/// @param even_deg  sigma of an even plane
double plane_prior(double even_deg, const SurfaceFindings& surface, const PlatformPlane& plane,
                   const Eigen::Isometry3d& levelled) {
  const double uneven = surface.unevenness.value_or(0);
  const double beyond_noise =
      std::sqrt(std::max(uneven * uneven - max_unevenness * max_unevenness, 0.0));
  const double z = levelled.inverse().translation().z();  // of the platform's middle
  return std::hypot(radians_from_degrees(even_deg),
                    beyond_noise * disparity_unit * z * std::abs(plane.offset) / unevenness_lever);
}

/// The angle between the solved axis and the plane's normal.
double direction_off(const AxisSolution& solution, const PlatformPlane& plane) {
  const Vector3d normal = solution.platform_from_sensor.linear() * plane.normal;
  return std::atan2(std::hypot(normal.x(), normal.y()), normal.z());
}

/// Whether the axis is further from the plane's normal than the object's own sigma explains.
/// @param solution  with the plane as a loose prior
/// @param prior     radians, its sigma
bool contradicts(const AxisSolution& solution, const PlatformPlane& plane, double prior) {
  const double sigma = solution.direction_sigma();
  // The object's own information: what the prior adds is subtracted.
  const double information = std::max(1 / (sigma * sigma) - 1 / (prior * prior), 1.0);
  return direction_off(solution, plane) > wobble_sigmas / std::sqrt(information);
}

/// Whether nothing slipped or moved: either would bias the focal length.
bool all_stand_as_told(const CalibrationReport& report) {
  return std::ranges::all_of(report.findings, [](const CalibrationFinding& finding) {
    return finding.code == "wobble" || finding.code == "no-map";
  });
}

bool has_slipped(const CalibrationReport& report) {
  return std::ranges::any_of(report.slipped, [](double angle) { return angle != 0; });
}

/// What a turn shows of slips of the platform or a move of the object.
struct TurnFaults {
  std::vector<CalibrationFinding> findings = {};
  std::vector<double> slipped = {};  ///< as in `CalibrationReport`
};

TurnFaults find_faults(CalibrationReport& report, const TurnViews& views,
                       const Eigen::Isometry3d& pose, int threads) {
  TurnFaults faults;
  if (const auto offsets = solve_stop_offsets(views, pose, threads)) {
    report.stop_offsets = offsets->offsets;
    faults.findings = find_slips(views.angles, *offsets);
    faults.slipped = slipped_angles(faults.findings, *offsets);
  }
  const auto step = solve_object_step(views, pose, threads);
  if (auto move = step ? find_move(*step) : std::nullopt) {
    faults = {.findings = {*std::move(move)}};  // which looks like a slip
  }
  return faults;
}

/// Solves the axis and the angles at which a platform that slipped stood. The angles were found
/// with an axis that the slips had shifted: each pass shows the rest.
/// @param views  get the angles
/// @param prior  as of `solve_axis`
std::optional<AxisSolution> solve_slipped(CalibrationReport& report, TurnViews& views,
                                          const PlatformPlane& plane, Eigen::Isometry3d pose,
                                          double prior, int threads) {
  constexpr int passes = 3;
  const std::vector<double> told = views.angles;
  std::optional<AxisSolution> solution;
  for (int pass = 0; pass < passes; ++pass) {
    std::ranges::transform(told, report.slipped, views.angles.begin(), std::plus<>());
    solution = solve_axis(views, plane, pose, prior, threads);
    const auto rest = solution ? solve_stop_offsets(views, solution->platform_from_sensor, threads)
                               : std::nullopt;
    if (!rest || pass + 1 == passes) {
      break;
    }
    pose = solution->platform_from_sensor;
    std::ranges::transform(report.slipped, slipped_angles(report.findings, *rest),
                           report.slipped.begin(), std::plus<>());
  }
  return solution;
}

/// Solves the axis, and detects faults that a new pose does not cure.
/// @param views    get the angles at which the platform stood, if it slipped
/// @param surface  a sensor that moved looks like a slip, or a move of the object
std::optional<AxisSolution> solve(CalibrationReport& report, TurnViews& views,
                                  const PlatformPlane& plane, const SurfaceFindings& surface,
                                  const Eigen::Isometry3d& levelled, int threads) {
  const double prior = plane_prior(loose_direction_deg, surface, plane, levelled);
  auto loose = solve_axis(views, plane, find_axis_start(views, levelled, threads), prior, threads);
  if (!loose) {
    return std::nullopt;
  }
  TurnFaults faults = find_faults(report, views, loose->platform_from_sensor, threads);
  const bool has_faults = !faults.findings.empty();
  if (!surface.bump) {
    report.findings.insert(report.findings.begin(), faults.findings.begin(), faults.findings.end());
    report.slipped = std::move(faults.slipped);
  }
  if (has_slipped(report)) {
    loose = solve_slipped(report, views, plane, loose->platform_from_sensor, prior, threads);
    if (!loose) {
      return std::nullopt;
    }
  }
  // A slip or a move tilts the axis, too.
  if (!has_faults && contradicts(*loose, plane, prior)) {
    return loose;
  }
  return solve_axis(views, plane, loose->platform_from_sensor,
                    plane_prior(tight_direction_deg, surface, plane, levelled), threads);
}

/// Sets the distances of a solution from the configured pose.
void compare_with_told(CalibrationReport& report, const Eigen::Isometry3d& configured) {
  const Eigen::Isometry3d solved_from_told = report.platform_from_sensor * configured.inverse();
  const Vector3d origin = solved_from_told.translation();
  const Vector3d axis = solved_from_told.linear() * Vector3d::UnitZ();
  report.shift = std::hypot(origin.x(), origin.y());
  report.lift = std::abs(origin.z());
  report.tilt = std::atan2(std::hypot(axis.x(), axis.y()), axis.z());
}

std::string refuse_plane(const std::optional<PlatformPlane>& plane) {
  if (!plane || plane->inliers < min_plane_inliers || plane->inlier_share < min_plane_share) {
    return "the platform was not found: too little of its surface is seen near where it should be";
  }
  if (plane->rms > max_plane_rms) {
    return "the platform's surface is not flat: " + mm_text(plane->rms, text_digits);
  }
  return {};
}

std::string refuse_object(const TurnViews& views) {
  if (views.pairs.size() < min_pairs) {
    return "too few stops: the object must be seen from at least four directions of a turn";
  }
  if (mean_object_pixels(views) < min_object_pixels) {
    return "too little of an object is seen: stand something larger on the platform";
  }
  return {};
}

/// Whether the configured pose lies within the uncertainty of the solved one.
bool agrees_with_told(const CalibrationReport& report) {
  const double near = std::max(agreeing_shift, agreeing_sigmas * report.position_sigma);
  return report.shift <= near && report.lift <= near &&
         report.tilt <= std::max(radians_from_degrees(agreeing_tilt_deg),
                                 agreeing_sigmas * report.direction_sigma);
}

/// Metres: a last step of the axis up to this one counts as converged.
double max_step(double position_sigma) {
  return std::max(max_last_step, settled_sigmas * position_sigma);
}

/// Refuses a pose from few stops if poses that are solved without one of the stops do not fit that
/// stop much better than the configured one does, on average over all stops.
/// @param views  has its pairs again at the end
/// @param prior  as of `solve_axis`
std::string refuse_few_stops(const CalibrationReport& report, TurnViews& views,
                             const PlatformPlane& plane, const CalibrationTurn& turn, double prior,
                             int threads) {
  if (turn.angles.size() > few_stops || report.optics_differ || agrees_with_told(report)) {
    return {};
  }
  const std::vector<StopPair> all = views.pairs;
  const std::vector<double> as_told(turn.angles.size(), 0.0);
  double before = 0;
  double after = 0;
  for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
    const auto has_stop = [&](const StopPair& pair) {
      return pair.from == stop || pair.to == stop;
    };
    views.pairs.clear();
    std::ranges::remove_copy_if(all, std::back_inserter(views.pairs), has_stop);
    const auto rest = solve_axis(views, plane, report.platform_from_sensor, prior, threads);
    views.pairs.clear();
    std::ranges::copy_if(all, std::back_inserter(views.pairs), has_stop);
    const Eigen::Isometry3d& pose = rest ? rest->platform_from_sensor : turn.platform_from_sensor;
    before += median_residual(views, turn.platform_from_sensor, as_told, threads);
    after += median_residual(views, pose, as_told, threads);
  }
  views.pairs = all;
  return after < (1 - gain_times_stops / static_cast<double>(turn.angles.size())) * before
             ? ""
             : "too few stops: a pose from all but one of them does not fit that one";
}

std::string refuse_solution(const CalibrationReport& report, double last_step) {
  if (last_step > max_step(report.position_sigma)) {
    return "the axis did not settle";
  }
  const double moved = std::hypot(report.shift, report.lift);
  if (report.position_sigma > std::max(max_position_sigma, worthwhile_sigma * moved)) {
    return "the axis is uncertain by " + mm_text(report.position_sigma, text_digits) +
           ": stand another object on the platform";
  }
  if (report.direction_sigma > std::max(radians_from_degrees(max_direction_sigma_deg),
                                        worthwhile_direction_sigma * report.tilt)) {
    return "the axis is uncertain by " + degrees_text(report.direction_sigma, text_digits) +
           ": stand another object on the platform";
  }
  if (report.after > max_after) {
    return "the stops disagree by " + mm_text(report.after, text_digits) + ": something moved";
  }
  // If configured and solved pose agree within sigma, a difference of their medians means nothing.
  if (report.after > may_worsen * report.before && !agrees_with_told(report)) {
    return "the stops agree better with the configured pose";
  }
  if (moved > max_shift || report.tilt > radians_from_degrees(max_tilt_deg)) {
    return "the sensor stands " + mm_text(moved, text_digits) + " and " +
           degrees_text(report.tilt, text_digits) + " from the configured place: calibrate the rig";
  }
  return {};
}

/// Whether the optics may be solved: nothing slipped or moved. A sensor that is uneven, and has no
/// map, needs more than a few stops, as its pattern then looks like other optics; what is known of
/// its optics already is more exact than such a turn.
/// @param pattern  as of `solve_optics`
bool shows_optics(const CalibrationTurn& turn, const CalibrationReport& report, double pattern) {
  const bool is_solvable = pattern > 0 ? !turn.optics && turn.angles.size() > few_stops
                                       : !turn.optics || turn.optics->sigma.fx > 0;
  return is_solvable && all_stand_as_told(report);
}

struct TakenOptics {
  double last_step = 0;          // of the axis, metres
  bool are_significant = false;  // far from those with which the turn was read
};

/// Solves optics and pose together, and takes both if the turn knows the optics better.
/// @param pattern  as of `solve_optics`
std::optional<TakenOptics> take_optics(CalibrationReport& report, TurnViews& views,
                                       const TurnReader& reader, const CalibrationTurn& turn,
                                       double pattern, int threads) {
  const auto solved = solve_optics(views, reader.samples(), reader.plane(), turn,
                                   report.platform_from_sensor, pattern, threads);
  if (!solved) {
    return std::nullopt;
  }
  const bool are_significant =
      solved->significance >= (pattern > 0 ? min_focal_significance : min_significance);
  report.optics = solved->optics;
  const double error = std::abs(solved->optics.value.fx / turn.intrinsics.fx - 1);
  const bool is_settled = solved->axis.last_step <= max_step(solved->axis.position_sigma());
  // Known optics are better than a turn's that did not settle.
  if ((!are_significant && !solved->is_better) || (turn.optics && !is_settled)) {
    return std::nullopt;
  }
  if (error > max_focal_error) {
    report.findings.push_back(describe_focal_length(solved->optics.value.fx, turn.intrinsics.fx));
    return std::nullopt;
  }
  report.optics_differ = true;
  report.platform_from_sensor = solved->axis.platform_from_sensor;
  report.position_sigma = solved->axis.position_sigma();
  // That of an uneven sensor would refuse poses that are no worse than without its optics.
  if (pattern == 0) {
    report.direction_sigma = solved->axis.direction_sigma();
  }
  const std::vector<double> as_told(turn.angles.size(), 0.0);
  report.after = median_residual(views, report.platform_from_sensor, as_told, threads);
  return TakenOptics{.last_step = solved->axis.last_step, .are_significant = are_significant};
}

CalibrationReport refused(CalibrationReport report, const std::string& reason) {
  report.reason = reason;
  return report;
}

/// Whether the platform turned otherwise than configured.
bool names_turn(const CalibrationReport& report) {
  return std::ranges::any_of(report.findings, [](const CalibrationFinding& finding) {
    return finding.code == "still" || finding.code == "turn-ratio" ||
           finding.code == "turn-unknown";
  });
}

/// Explains a turn that was refused, or in which something slipped, by how the platform turned.
/// @return why the pose is refused
std::string explain_turn(CalibrationReport& report, const TurnRatio& turned, std::size_t stops,
                         std::string reason) {
  const bool has_cause = !all_stand_as_told(report);
  auto wrong = find_wrong_turn(turned, stops);
  if (wrong && !(has_cause && wrong->code == "turn-unknown")) {
    reason = wrong->detail;
    report.findings = {*std::move(wrong)};
  } else if (turned.is_alike() && !reason.empty() && !has_cause) {
    reason =
        "the object looks the same from all sides, and shows neither the axis nor whether the "
        "platform turned: stand another object on the platform";
    report.findings.clear();
    if (report.before > max_after) {
      report.findings.push_back(describe_alike());
    }
  }
  return reason;
}

}  // namespace

bool CalibrationReport::confirms_told() const {
  return accepted && !optics_differ && !has_slipped(*this) && agrees_with_told(*this);
}

CalibrationReport calibrate(const CalibrationTurn& turn, int threads) {
  CalibrationReport report;
  TurnReader reader(turn, threads);
  if (const std::string reason = refuse_plane(reader.find_platform()); !reason.empty()) {
    return refused(std::move(report), reason);
  }
  TurnViews views = reader.read_views();
  const PlatformPlane& plane = reader.plane();
  const Eigen::Isometry3d levelled = level(turn.platform_from_sensor, plane);
  if (const std::string reason = refuse_object(views); !reason.empty()) {
    return refused(std::move(report), reason);
  }
  const SurfaceFindings surface =
      look_at_surface(report, reader.samples(), plane, turn.angles, levelled);
  const auto solution = solve(report, views, plane, surface, levelled, threads);
  const bool is_uneven = !turn.has_sensor_map && surface.unevenness.value_or(0) > max_unevenness;
  if (is_uneven && !surface.bump) {
    add_no_map(report, *surface.unevenness);
  }
  if (!solution) {
    const TurnRatio turned =
        find_turn_ratio(views, turn.angles, plane, levelled, levelled, threads);
    const std::string reason = explain_turn(report, turned, turn.angles.size(),
                                            "too little of the object is seen from two stops");
    return refused(std::move(report), reason);
  }
  const std::vector<double> as_told(turn.angles.size(), 0.0);
  report.platform_from_sensor = solution->platform_from_sensor;
  report.position_sigma = solution->position_sigma();
  report.direction_sigma = solution->direction_sigma();
  report.before = median_residual(views, turn.platform_from_sensor, as_told, threads);
  report.after = median_residual(views, report.platform_from_sensor, as_told, threads);
  double last_step = solution->last_step;
  const double pattern = is_uneven ? *surface.unevenness : 0;
  const auto optics = shows_optics(turn, report, pattern)
                          ? take_optics(report, views, reader, turn, pattern, threads)
                          : std::nullopt;
  if (optics && !is_uneven) {  // the pattern moves the axis by far more than a last step
    last_step = optics->last_step;
  }
  compare_with_told(report, turn.platform_from_sensor);
  std::string reason = surface.bump && surface.bump->size > max_after
                           ? report.findings.front().detail
                           : refuse_solution(report, last_step);
  if (reason.empty()) {
    reason = refuse_few_stops(report, views, plane, turn,
                              plane_prior(tight_direction_deg, surface, plane, levelled), threads);
  }
  if (!surface.bump && (!reason.empty() || !all_stand_as_told(report) ||
                        looks_still(views, levelled, report.platform_from_sensor, threads))) {
    const TurnRatio turned =
        find_turn_ratio(views, turn.angles, plane, levelled, report.platform_from_sensor, threads);
    reason = explain_turn(report, turned, turn.angles.size(), std::move(reason));
  }
  report.accepted = reason.empty();
  if (optics && optics->are_significant && !report.accepted && !names_turn(report)) {
    report.findings.push_back(describe_unused_optics(report.optics->value, turn.intrinsics));
  }
  return refused(std::move(report), reason);
}

}  // namespace octurn
