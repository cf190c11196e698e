#include "calibrate/stop_offsets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <span>

#include "calibrate/for_each_stop.hpp"
#include "io/number_text.hpp"
#include "octurn/median.hpp"
#include "octurn/units.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr std::array angle_schedule = {
    ResidualLimits{.max_distance = 0.02, .cauchy_scale = 0.004},
    ResidualLimits{.max_distance = 0.02, .cauchy_scale = 0.004},
    ResidualLimits{.max_distance = 0.02, .cauchy_scale = 0.003},
    ResidualLimits{.max_distance = 0.01, .cauchy_scale = 0.002},
    ResidualLimits{.max_distance = 0.005, .cauchy_scale = 0.002},
    ResidualLimits{.max_distance = 0.005, .cauchy_scale = 0.002},
};

constexpr double max_sigma_deg = 1.0;  // of a stop's angle
// Root mean square change of the residuals with a stop's angle, metres per radian. Below it the
// object is one of revolution. Measured in 1/1000: vase and ball 4 to 5, mostly noise of the
// normals; flat box 9 to 12; objects with limbs 20 and more.
constexpr double min_sensitivity = 0.007;
constexpr double min_slip_deg = 0.6;
constexpr double slip_sigmas = 3;
constexpr double slip_to_noise = 5;  // times the median step, which is the sensor's fixed pattern
// A slip lasts: the platform stays where it slipped to. An object that is seen from its narrow side
// is off for one to three stops, and one before a sensor with a pattern for three to ten, by up to
// a degree.
constexpr double min_explained = 0.5;  // of the offsets' squares about their mean, by the step

constexpr std::size_t max_slips = 8;

// A sensor's fixed pattern alone looks like a turn of 356 degrees.
constexpr double min_drift_deg = 8;
constexpr double straight = 0.97;  // correlation of drift and angle

/// The pairs from one stop in the normal equations: an entry for each partner.
struct PairAngleSums {
  std::size_t to = 0;
  double from_from = 0;
  double from_to = 0;
  double to_to = 0;
  double right_from = 0;
  double right_to = 0;
};

struct StopAngleSums {
  std::vector<PairAngleSums> pairs = {};
  double weight = 0;
  double squares = 0;
};

StopAngleSums angle_sums(const TurnViews& turn, const Eigen::Isometry3d& pose,
                         const std::vector<double>& offsets, std::size_t stop,
                         const ResidualLimits& limits) {
  StopAngleSums sums;
  for_each_residual(turn, pose, offsets, stop, limits, [&](const StopResidual& residual) {
    if (sums.pairs.empty() || sums.pairs.back().to != residual.to) {
      sums.pairs.push_back({.to = residual.to});
    }
    PairAngleSums& pair = sums.pairs.back();
    // A platform that stands further on by w has the point R(-w) p in the object's frame.
    const double by_from = -residual.normal_from.dot(Vector3d::UnitZ().cross(residual.point_from));
    const double by_to = residual.normal_to.dot(Vector3d::UnitZ().cross(residual.point_to));
    const double weight = limits.weight(residual.distance);
    pair.from_from += weight * by_from * by_from;
    pair.from_to += weight * by_from * by_to;
    pair.to_to += weight * by_to * by_to;
    pair.right_from -= weight * by_from * residual.distance;
    pair.right_to -= weight * by_to * residual.distance;
    sums.weight += weight;
    sums.squares += weight * residual.distance * residual.distance;
  });
  return sums;
}

struct AngleEquations {
  Eigen::MatrixXd normal_matrix;
  Eigen::VectorXd right;
  double variance = 0;
  double sensitivity = 0;  // metres for a radian, root mean square
};

AngleEquations angle_equations(const TurnViews& turn, const Eigen::Isometry3d& pose,
                               const std::vector<double>& offsets, const ResidualLimits& limits,
                               int threads) {
  const std::size_t stops = turn.views.size();
  std::vector<StopAngleSums> of_stops(stops);
  for_each_stop(stops, threads, [&](std::size_t stop) {
    of_stops[stop] = angle_sums(turn, pose, offsets, stop, limits);
  });
  const auto size = static_cast<Eigen::Index>(stops);
  AngleEquations all{.normal_matrix = Eigen::MatrixXd::Zero(size, size),
                     .right = Eigen::VectorXd::Zero(size)};
  double weight = 0;
  double squares = 0;
  for (std::size_t stop = 0; stop < stops; ++stop) {
    const auto from = static_cast<Eigen::Index>(stop);
    for (const PairAngleSums& pair : of_stops[stop].pairs) {
      const auto to = static_cast<Eigen::Index>(pair.to);
      all.normal_matrix(from, from) += pair.from_from;
      all.normal_matrix(to, to) += pair.to_to;
      all.normal_matrix(from, to) += pair.from_to;
      all.normal_matrix(to, from) += pair.from_to;
      all.right[from] += pair.right_from;
      all.right[to] += pair.right_to;
    }
    weight += of_stops[stop].weight;
    squares += of_stops[stop].squares;
  }
  all.variance = weight > 0 ? squares / weight * turn.correlation : 0;
  // Each residual has two stops.
  all.sensitivity = weight > 0 ? std::sqrt(all.normal_matrix.trace() / (2 * weight)) : 0;
  return all;
}

/// Largest sigma of a stop's angle, measured from the mean angle of all stops. Measured from the
/// first stop instead, every sigma would be large where that stop sees the object in profile.
/// @param covariance  of the offsets from the second stop on
double worst_sigma(const Eigen::MatrixXd& covariance) {
  const auto stops = static_cast<double>(covariance.rows() + 1);
  const double of_mean = covariance.sum() / (stops * stops);
  // var(x - m) = var(x) - 2 cov(x, m) + var(m); the first stop's x is 0.
  const double of_others =
      (covariance.diagonal() - 2 / stops * covariance.rowwise().sum()).maxCoeff();
  return std::sqrt(of_mean + std::max(0.0, of_others));
}

/// The sigma of the step from a stop to the next; the first stop's angle is fixed.
/// @param covariance  of the offsets from the second stop on
double step_sigma(const Eigen::MatrixXd& covariance, Eigen::Index stop) {
  if (stop == 0) {
    return std::sqrt(covariance(0, 0));
  }
  return std::sqrt(covariance(stop - 1, stop - 1) + covariance(stop, stop) -
                   2 * covariance(stop - 1, stop));
}

/// The mean of some offsets, radians.
double mean(std::span<const double> offsets) {
  return std::accumulate(offsets.begin(), offsets.end(), 0.0) / static_cast<double>(offsets.size());
}

/// The share of the offsets' squares about their mean that a step between two constants explains.
/// @param stop  the first after the step, from 1 on
/// @return      0 if the constants differ the other way than the offsets beside the step
double explained_by_step(std::span<const double> offsets, std::size_t stop) {
  const double middle = mean(offsets);
  double squares = 0;
  for (const double offset : offsets) {
    squares += (offset - middle) * (offset - middle);
  }
  const double step = mean(offsets.subspan(stop)) - mean(offsets.first(stop));
  const auto count = static_cast<double>(offsets.size());
  const auto before = static_cast<double>(stop);
  return step * (offsets[stop] - offsets[stop - 1]) > 0
             ? before * (count - before) / count * step * step / squares
             : 0;
}

/// The largest step between neighbouring stops, if it stands out of the others.
std::optional<CalibrationFinding> find_step(const StopOffsets& solved) {
  const std::vector<double>& offsets = solved.offsets;
  std::vector<double> steps;
  for (std::size_t stop = 1; stop < offsets.size(); ++stop) {
    steps.push_back(offsets[stop] - offsets[stop - 1]);
  }
  std::vector<double> sizes(steps.size());
  std::ranges::transform(steps, sizes.begin(), [](double step) { return std::abs(step); });
  const auto largest = std::ranges::max_element(sizes);
  const auto at = largest - sizes.begin();
  const auto middle = sizes.size() / 2;
  std::vector<double> sorted = sizes;
  std::ranges::sort(sorted);
  const double sigma = step_sigma(solved.covariance, at);
  if (*largest < radians_from_degrees(min_slip_deg) || *largest < slip_sigmas * sigma ||
      *largest < slip_to_noise * sorted[middle] ||
      explained_by_step(offsets, static_cast<std::size_t>(at) + 1) < min_explained) {
    return std::nullopt;
  }
  return describe_slip(static_cast<int>(at) + 1, steps[static_cast<std::size_t>(at)]);
}

std::optional<CalibrationFinding> find_drift(const std::vector<double>& angles,
                                             const std::vector<double>& offsets) {
  const auto count = static_cast<double>(angles.size());
  double sum_a = 0;
  double sum_o = 0;
  double sum_aa = 0;
  double sum_ao = 0;
  double sum_oo = 0;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    sum_a += angles[i];
    sum_o += offsets[i];
    sum_aa += angles[i] * angles[i];
    sum_ao += angles[i] * offsets[i];
    sum_oo += offsets[i] * offsets[i];
  }
  const double spread_a = sum_aa - sum_a * sum_a / count;
  const double spread_o = sum_oo - sum_o * sum_o / count;
  const double together = sum_ao - sum_a * sum_o / count;
  const double turn = 2 * std::numbers::pi;
  const double drift = turn * together / spread_a;
  if (std::abs(drift) < radians_from_degrees(min_drift_deg) ||
      std::abs(together) < straight * std::sqrt(spread_a * spread_o)) {
    return std::nullopt;
  }
  std::array<char, 64> ratio{};
  std::snprintf(ratio.data(), ratio.size(), "%.4f", turn / (turn + drift));
  return CalibrationFinding{.code = "turn-not-whole",
                            .detail = "a whole turn came out as " + degrees_text(turn + drift, 1),
                            .hint = "Multiply gear_ratio by " + std::string(ratio.data()) + ".",
                            .stop = {},
                            .angle = {},
                            .parameters = {{"turn_deg", degrees_from_radians(turn + drift)}}};
}

}  // namespace

CalibrationFinding describe_slip(int stop, double angle) {
  return {.code = "slip",
          .detail = "at stop " + std::to_string(stop) + " the platform stood " +
                    degrees_text(angle, 1) + " from where it should",
          .hint = "Look whether the platform slipped or the motor lost a step; turn more slowly.",
          .stop = stop,
          .angle = angle,
          .parameters = {{"stop", static_cast<double>(stop)},
                         {"off_deg", degrees_from_radians(angle)}}};
}

std::optional<StopOffsets> solve_stop_offsets(const TurnViews& turn,
                                              const Eigen::Isometry3d& platform_from_sensor,
                                              int threads) {
  const std::size_t stops = turn.views.size();
  StopOffsets solved{.offsets = std::vector<double>(stops, 0.0), .covariance = {}};
  for (const ResidualLimits& limits : angle_schedule) {
    const AngleEquations all =
        angle_equations(turn, platform_from_sensor, solved.offsets, limits, threads);
    if (all.sensitivity < min_sensitivity) {
      return std::nullopt;
    }
    // Angles are measured from the first stop.
    const auto free = static_cast<Eigen::Index>(stops) - 1;
    const auto motion =
        solve_symmetric(all.normal_matrix.bottomRightCorner(free, free), all.right.tail(free));
    if (!motion) {
      return std::nullopt;
    }
    for (Eigen::Index i = 0; i < free; ++i) {
      solved.offsets[static_cast<std::size_t>(i) + 1] += motion->values[i];
    }
    solved.covariance = motion->inverse * all.variance;
  }
  return worst_sigma(solved.covariance) < radians_from_degrees(max_sigma_deg)
             ? std::optional(std::move(solved))
             : std::nullopt;
}

std::vector<CalibrationFinding> find_slips(const std::vector<double>& angles,
                                           const StopOffsets& solved) {
  std::vector<CalibrationFinding> findings;
  if (auto drift = find_drift(angles, solved.offsets)) {
    findings.push_back(*std::move(drift));
    return findings;
  }
  StopOffsets rest = solved;
  for (auto slip = find_step(rest); slip && findings.size() < max_slips; slip = find_step(rest)) {
    const auto after = std::span(rest.offsets).subspan(static_cast<std::size_t>(*slip->stop));
    std::ranges::transform(after, after.begin(),
                           [&](double offset) { return offset - *slip->angle; });
    findings.push_back(*std::move(slip));
  }
  std::ranges::sort(findings, {}, &CalibrationFinding::stop);
  return findings;
}

std::vector<double> slipped_angles(const std::vector<CalibrationFinding>& findings,
                                   const StopOffsets& solved) {
  std::vector<double> slipped(solved.offsets.size(), 0.0);
  std::vector<std::size_t> ends;
  for (const CalibrationFinding& finding : findings) {
    if (finding.code == "slip") {
      ends.push_back(static_cast<std::size_t>(*finding.stop));
    }
  }
  ends.push_back(slipped.size());
  std::size_t from = 0;
  double first = 0;
  for (const std::size_t end : ends) {
    const auto part = std::span(solved.offsets).subspan(from, end - from);
    const double middle = median(std::vector<double>(part.begin(), part.end()));
    first = from == 0 ? middle : first;
    std::fill(slipped.begin() + static_cast<std::ptrdiff_t>(from),
              slipped.begin() + static_cast<std::ptrdiff_t>(end), middle - first);
    from = end;
  }
  return slipped;
}

}  // namespace octurn
