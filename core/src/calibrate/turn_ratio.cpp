#include "calibrate/turn_ratio.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calibrate/axis_solver.hpp"
#include "calibrate/for_each_stop.hpp"
#include "io/number_text.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::array wrong_ratios = {-1.0, 2.0, 0.5, -2.0, -0.5, 3.0, 4.0, 1.0 / 3, 0.25};

constexpr double confirming_distance = 0.004;  // metres: a Kinect's noise, and what it leaves of
                                               // its pattern
constexpr double confirming_cosine = 0.9;      // between two normals of one surface
constexpr double facing_cosine = 0.25;         // as of readings
constexpr double hidden_behind = 0.008;        // metres behind what a stop saw: it may be hidden

// Shares of the readings. The right ratio confirms 0.9 and more of them, a wrong one 0.3 and less,
// of a bunny; of an object of revolution all confirm about as many.
constexpr double min_confirmed = 0.7;    // by the right ratio
constexpr double distinguishable = 0.7;  // of these, by the configured angles
// One picture confirms itself, and a flat thing that lies still nine tenths of itself turned.
constexpr double min_still = 0.95;
constexpr double distinguishable_from_still = 0.93;

/// Numbers of readings whose surface another stop could see, and of those whose surface it saw.
struct Confirmed {
  double all = 0;
  double confirmed = 0;
};

Confirmed count_confirmed(const TurnViews& turn, const Isometry3d& pose, double ratio,
                          std::size_t from) {
  Confirmed count;
  const Isometry3d back = pose.inverse();
  for (const StopPair& pair : turn.pairs) {
    if (pair.from != from) {
      continue;
    }
    const double angle = ratio * (turn.angles[pair.to] - turn.angles[from]);
    const Isometry3d to_from_from = back * Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * pose;
    for (const SurfaceReading& reading : turn.readings[from]) {
      const Vector3d point = to_from_from * reading.point;
      const Vector3d normal = to_from_from.linear() * reading.normal;
      if (-normal.dot(point.normalized()) < facing_cosine) {
        continue;
      }
      const auto surface = turn.views[pair.to].look_up(point);
      if (!surface || point.z() > surface->point.z() + hidden_behind) {
        continue;
      }
      ++count.all;
      count.confirmed +=
          std::abs(surface->normal.dot(point - surface->point)) < confirming_distance &&
                  surface->normal.dot(normal) > confirming_cosine
              ? 1
              : 0;
    }
  }
  return count;
}

/// The share of the readings that other stops confirm.
/// @param ratio  of the angles between the stops
double confirmed_share(const TurnViews& turn, const Isometry3d& pose, double ratio, int threads) {
  std::vector<Confirmed> of_stops(turn.views.size());
  for_each_stop(of_stops.size(), threads, [&](std::size_t stop) {
    of_stops[stop] = count_confirmed(turn, pose, ratio, stop);
  });
  Confirmed sum;
  for (const Confirmed& stop : of_stops) {
    sum.all += stop.all;
    sum.confirmed += stop.confirmed;
  }
  return sum.confirmed / std::max(sum.all, 1.0);
}

/// The share with the axis that fits best to a ratio.
double share_with_ratio(TurnViews& turn, std::vector<double> angles, const PlatformPlane& plane,
                        const Isometry3d& levelled, double ratio, int threads) {
  for (double& angle : angles) {
    angle *= ratio;
  }
  std::vector<StopPair> pairs = make_stop_pairs(angles);
  std::swap(turn.angles, angles);
  std::swap(turn.pairs, pairs);
  const Isometry3d start = find_axis_start(turn, levelled, threads);
  const auto solution =
      solve_axis(turn, plane, start, radians_from_degrees(loose_direction_deg), threads);
  double share = confirmed_share(turn, start, 1, threads);
  if (solution) {
    share = std::max(share, confirmed_share(turn, solution->platform_from_sensor, 1, threads));
  }
  std::swap(turn.angles, angles);
  std::swap(turn.pairs, pairs);
  return share;
}

constexpr double example_deg = 90;

std::string describe(double ratio) {
  return "where the platform should turn by " + number_text("%.0f", example_deg) +
         " degrees counter-clockwise, seen from above, it turned by " +
         number_text("%g", example_deg * std::abs(ratio)) +
         (ratio < 0 ? " degrees clockwise" : " degrees");
}

std::string advise(double ratio) {
  const std::string other_way = "change \"Turn the other way\"";
  const std::string ratios = "divide the gear ratio by " + number_text("%g", std::abs(ratio));
  return "In the turntable's settings " +
         (ratio == -1 ? other_way
          : ratio < 0 ? ratios + " and " + other_way
                      : ratios) +
         ", then test a turn.";
}

}  // namespace

bool TurnRatio::is_alike() const {
  return ratio == 1 && as_told >= min_confirmed && still > distinguishable * as_told;
}

bool looks_still(const TurnViews& turn, const Isometry3d& levelled, const Isometry3d& solved,
                 int threads) {
  const double still = confirmed_share(turn, levelled, 0, threads);
  return still > min_still &&
         confirmed_share(turn, solved, 1, threads) < distinguishable_from_still * still;
}

TurnRatio find_turn_ratio(TurnViews& turn, const std::vector<double>& told,
                          const PlatformPlane& plane, const Isometry3d& levelled,
                          const Isometry3d& solved, int threads) {
  TurnRatio found{.as_told = std::max(confirmed_share(turn, solved, 1, threads),
                                      share_with_ratio(turn, told, plane, levelled, 1, threads)),
                  .still = confirmed_share(turn, levelled, 0, threads)};
  found.confirmed = found.as_told;
  const auto may_be = [&](double ratio, double confirmed) {
    if (confirmed > min_confirmed && confirmed > found.confirmed &&
        found.as_told < distinguishable * confirmed) {
      found.ratio = ratio;
      found.confirmed = confirmed;
    }
  };
  if (found.still > min_still && found.as_told < distinguishable_from_still * found.still) {
    found.ratio = 0;
    found.confirmed = found.still;
  }
  for (const double ratio : wrong_ratios) {
    may_be(ratio, share_with_ratio(turn, told, plane, levelled, ratio, threads));
  }
  return found;
}

CalibrationFinding describe_alike() {
  return {.code = "alike",
          .detail =
              "the stops disagree, and the object, which looks the same from all sides, does "
              "not show why: it comes out too small or too large",
          .hint = "Calibrate with another object first, then build the model again.",
          .stop = {},
          .angle = {},
          .parameters = {}};
}

std::optional<CalibrationFinding> find_wrong_turn(const TurnRatio& turn, std::size_t stops) {
  if (turn.ratio == 0) {
    return CalibrationFinding{
        .code = "still",
        .detail = "each of " + std::to_string(stops) +
                  " stops shows what the first one shows: the platform did not turn",
        .hint = "Look at the motor, its power and its wiring.",
        .stop = {},
        .angle = {},
        .parameters = {{"stops", static_cast<double>(stops)}}};
  }
  if (turn.ratio != 1) {
    return CalibrationFinding{.code = "turn-ratio",
                              .detail = describe(turn.ratio),
                              .hint = advise(turn.ratio),
                              .stop = {},
                              .angle = {},
                              .parameters = {{"told_deg", example_deg},
                                             {turn.ratio < 0 ? "clockwise_deg" : "turned_deg",
                                              example_deg * std::abs(turn.ratio)}}};
  }
  if (turn.as_told < min_confirmed) {
    return CalibrationFinding{
        .code = "turn-unknown",
        .detail = "the stops do not show one object that turned as it should",
        .hint = "Test a turn in the turntable's settings; look that nothing slips or moves.",
        .stop = {},
        .angle = {},
        .parameters = {}};
  }
  return std::nullopt;
}

}  // namespace octurn
