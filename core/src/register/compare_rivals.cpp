#include "register/compare_rivals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "octurn/units.hpp"
#include "register/reading_fit.hpp"
#include "register/same_shape.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double min_lead = 0.10;
constexpr double similar_overlap = 0.85;  // of the best one's
constexpr double similar_residual = 1.3;

constexpr double near_angle = 0.26;        // radians, 15 degrees: reach of a fit to the readings
constexpr double joined_angle = 0.01;      // radians
constexpr double joined_distance = 0.001;  // metres
constexpr double joined_sigmas = 3;        // sigma of the difference, where that is more

/// Whether a candidate fits about as well as the best one, with about the same overlap: a pose that
/// slid along the surface has less.
bool is_rival(const PoseCandidate& candidate, const PoseCandidate& best) {
  return fits_alike(candidate, best) && candidate.overlap >= similar_overlap * best.overlap;
}

double angle_between(const Isometry3d& one, const Isometry3d& other) {
  return Eigen::AngleAxisd(one.linear().transpose() * other.linear()).angle();
}

/// Whether refinement on the readings takes two candidates to the same pose, within three sigma.
/// The mean points of few or noisy stops leave some degrees of a pose undetermined; the readings
/// determine it better.
bool readings_join(const Target& target, const SeenTurn& turn, const Vector3d& middle,
                   const Isometry3d& one, const Isometry3d& other, int threads,
                   const std::stop_token& stop) {
  const auto fit = [&](const Isometry3d& start) {
    return fit_readings(target.turns, turn, start, start * middle, threads, stop);
  };
  const ReadingFit a = fit(one);
  const ReadingFit b = fit(other);
  const double direction_sigma = std::hypot(a.direction_sigma, b.direction_sigma);
  const double position_sigma = std::hypot(a.position_sigma, b.position_sigma);
  return angle_between(a.object_from_turn, b.object_from_turn) <
             std::max(joined_angle, joined_sigmas * direction_sigma) &&
         (a.object_from_turn * middle - b.object_from_turn * middle).norm() <
             std::max(joined_distance, joined_sigmas * position_sigma);
}

std::string ambiguous(double angle) {
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(),
                "two poses that are %.0f degrees apart fit alike, and give different shapes",
                degrees_from_radians(angle));
  return text.data();
}

}  // namespace

bool fits_alike(const PoseCandidate& candidate, const PoseCandidate& best) {
  return candidate.contradiction <= best.contradiction + min_lead &&
         candidate.residual <= similar_residual * best.residual;
}

Rivals compare_rivals(const Target& target, const SeenTurn& turn, const NearestPoints& points,
                      const std::vector<PoseCandidate>& candidates, int threads,
                      const std::stop_token& stop) {
  const PoseCandidate& best = candidates.front();
  Rivals rivals;
  for (auto other = candidates.begin() + 1; other != candidates.end(); ++other) {
    if (!is_rival(*other, best)) {
      continue;
    }
    const double angle = angle_between(best.target_from_points, other->target_from_points);
    const bool is_near = angle <= near_angle;
    if (same_shape(target.points, points, best, *other)) {
      rivals.symmetric = rivals.symmetric || !is_near;
      continue;
    }
    if (!is_near || !readings_join(target, turn, points.middle(), best.target_from_points,
                                   other->target_from_points, threads, stop)) {
      rivals.reason = ambiguous(angle);
      break;
    }
  }
  return rivals;
}

}  // namespace octurn
