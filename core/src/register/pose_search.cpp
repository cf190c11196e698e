#include "register/pose_search.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "parallel/fork_join.hpp"
#include "register/reading_fit.hpp"
#include "register/rigid_fit.hpp"
#include "register/seen_turn.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr std::size_t rotations = 4416;
constexpr std::size_t coarse_points = 100;
constexpr int coarse_shifts = 4;
constexpr std::size_t coarse_kept = 500;
constexpr std::size_t fine_points = 300;
constexpr int fine_shifts = 1;
constexpr std::size_t kept = 100;
constexpr double search_agreement = 0.3;  // cosine between normals: rotations are 15 degrees apart
constexpr double min_point_agreement = 0.6;  // cosine between two normals of one surface
constexpr double far_limit = 0.012;          // metres, at the first iteration
constexpr double near_limit = 0.004;         // at the last
constexpr int approach = 8;                  // iterations from the first limit to the last
constexpr double point_cauchy_scale = 0.002;
constexpr double settled_search = 1e-5;  // metres
constexpr double point_contact_weight =
    4;  // of a foot's point: a platform is known better than a reading

// Poses that differ by less count as one.
constexpr double same_angle_deg = 4;
constexpr double same_shift = 0.005;  // metres

/// Rotation `i` of a set that covers all rotations evenly (Alexa 2022).
Eigen::Matrix3d to_rotation(std::size_t i) {
  constexpr double psi = 1.533751168755204288118041;  // psi^4 = psi + 4
  const double s = static_cast<double>(i) + 0.5;
  const double part = s / static_cast<double>(rotations);
  const double alpha = 2 * std::numbers::pi * s / std::numbers::sqrt2;
  const double beta = 2 * std::numbers::pi * s / psi;
  const double r = std::sqrt(part);
  const double rest = std::sqrt(1 - part);
  return Eigen::Quaterniond(rest * std::cos(beta), r * std::sin(alpha), r * std::cos(alpha),
                            rest * std::sin(beta))
      .toRotationMatrix();
}

std::vector<SurfacePoint> turned(const std::vector<SurfacePoint>& points,
                                 const Eigen::Matrix3d& rotation) {
  std::vector<SurfacePoint> turned;
  turned.reserve(points.size());
  for (const SurfacePoint& point : points) {
    turned.push_back({.point = rotation * point.point, .normal = rotation * point.normal});
  }
  return turned;
}

/// How badly points fit one side of a search.
struct Misfit {
  double distance = 0;  ///< metres, mean, capped
  Vector3d to_surface =
      Vector3d::Zero();  ///< metres, mean over points near a surface of like normal
};

/// Points in unknown space, neither surface nor free, count 0: one turn sees the underside that is
/// hidden in the other.
Misfit measure_misfit(const SearchedSide& side, const std::vector<SurfacePoint>& points,
                      const Vector3d& shift) {
  Misfit misfit;
  int near = 0;
  for (const SurfacePoint& point : points) {
    const Vector3d at = point.point + shift;
    const SurfacePoint* const nearest = side.nearest.find(at);
    if (nearest != nullptr && nearest->normal.dot(point.normal) > search_agreement) {
      const Vector3d to_nearest = nearest->point - at;
      misfit.distance += std::min(to_nearest.norm(), NearestPoints::cap);
      misfit.to_surface += to_nearest;
      ++near;
    } else if (side.free.is_free(at)) {
      misfit.distance += NearestPoints::cap;
    }
  }
  misfit.distance /= static_cast<double>(points.size());
  misfit.to_surface /= std::max(near, 1);
  return misfit;
}

/// A subset of the points of both sides.
struct Sample {
  std::vector<SurfacePoint> target;
  std::vector<SurfacePoint> turn;
};

/// Shifts a candidate `shifts` times by the mean offset to the target's surface, and measures its
/// distance in both directions.
void shift(PoseCandidate& candidate, const SearchedSide& target, const SearchedSide& turn,
           const Sample& sample, int shifts) {
  Eigen::Isometry3d& pose = candidate.target_from_points;
  const std::vector<SurfacePoint> points = turned(sample.turn, pose.linear());
  for (int i = 0; i < shifts; ++i) {
    pose.translation() += measure_misfit(target, points, pose.translation()).to_surface;
  }
  const Eigen::Isometry3d back = pose.inverse();
  candidate.distance =
      measure_misfit(target, points, pose.translation()).distance +
      measure_misfit(turn, turned(sample.target, back.linear()), back.translation()).distance;
}

/// Shifts all candidates, and keeps the `count` best.
void keep_best(std::vector<PoseCandidate>& candidates, const SearchedSide& target,
               const SearchedSide& turn, const Sample& sample, int shifts, std::size_t count,
               int threads, const std::stop_token& stop) {
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int) {
    for (std::size_t i = next++; i < candidates.size(); i = next++) {
      throw_if_stopped(stop);
      shift(candidates[i], target, turn, sample, shifts);
    }
  });
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(count), {},
                            [&](std::size_t i) { return std::pair(candidates[i].distance, i); });
  std::vector<PoseCandidate> best;
  best.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    best.push_back(candidates[order[i]]);
  }
  candidates = std::move(best);
}

/// One candidate for each rotation, which puts the turn's bounding box on the centre of the
/// target's.
std::vector<PoseCandidate> centred_candidates(const SearchedSide& target, const Sample& sample) {
  std::vector<PoseCandidate> candidates(rotations);
  for (std::size_t i = 0; i < rotations; ++i) {
    Eigen::Isometry3d& pose = candidates[i].target_from_points;
    pose.linear() = to_rotation(i);
    pose.translation() = target.nearest.middle() - find_middle(turned(sample.turn, pose.linear()));
  }
  return candidates;
}

/// Builds the normal equations of the points that lie within `limit` (metres) of the target.
RigidFit fit(const NearestPoints& target, const std::vector<SurfacePoint>& points,
             const Eigen::Isometry3d& pose, double limit) {
  RigidFit fit{.middle = target.middle()};
  for (const SurfacePoint& point : points) {
    const Vector3d at = pose * point.point;
    const SurfacePoint* const nearest = target.find(at);
    if (nearest == nullptr || (nearest->point - at).squaredNorm() > limit * limit ||
        nearest->normal.dot(pose.linear() * point.normal) < min_point_agreement) {
      continue;
    }
    const double distance = nearest->normal.dot(at - nearest->point);
    fit.add(at, nearest->normal, distance, cauchy_weight(distance, point_cauchy_scale));
  }
  return fit;
}

void add_contacts(RigidFit& fit, const PlatformConstraints& constraints,
                  const std::vector<SurfacePoint>& points, const Eigen::Isometry3d& pose) {
  for (const Eigen::Isometry3d& target_from_platform : constraints.target_from_platforms) {
    const Contact foot =
        find_contact(points, target_from_platform.inverse() * pose, constraints.share);
    add_moving_foot(fit, foot, pose, point_contact_weight);
  }
  const Contact foot =
      find_contact(constraints.target_points, pose.inverse(), constraints.target_share);
  add_moving_platform(fit, foot, Eigen::Isometry3d::Identity(), point_contact_weight);
}

}  // namespace

std::vector<PoseCandidate> search_poses(const SearchedSide& target, const SearchedSide& turn,
                                        int threads, const std::stop_token& stop) {
  const auto sample = [&](std::size_t count) {
    return Sample{.target = thinned(target.nearest.points(), count),
                  .turn = thinned(turn.nearest.points(), count)};
  };
  const Sample coarse = sample(coarse_points);
  std::vector<PoseCandidate> candidates = centred_candidates(target, coarse);
  keep_best(candidates, target, turn, coarse, coarse_shifts, coarse_kept, threads, stop);
  keep_best(candidates, target, turn, sample(fine_points), fine_shifts, kept, threads, stop);
  return candidates;
}

PoseCandidate refine(const NearestPoints& target, const PlatformConstraints& constraints,
                     const std::vector<SurfacePoint>& points, PoseCandidate candidate,
                     int iterations) {
  Eigen::Isometry3d& pose = candidate.target_from_points;
  for (int i = 0; i < iterations; ++i) {
    const double far = std::max(1 - static_cast<double>(i) / approach, 0.0);
    const double limit = near_limit + far * (far_limit - near_limit);
    RigidFit step = fit(target, points, pose, limit);
    add_contacts(step, constraints, points, pose);
    const Eigen::Isometry3d motion = step.motion();
    pose = motion * pose;
    if (i > approach && motion_length(motion, target.middle()) < settled_search) {
      break;
    }
  }
  const RigidFit last = fit(target, points, pose, near_limit);
  candidate.overlap = static_cast<double>(last.count) / static_cast<double>(points.size());
  candidate.residual = last.weight > 0 ? std::sqrt(last.squares / last.weight) : 0;
  return candidate;
}

std::vector<PoseCandidate> distinct(const std::vector<PoseCandidate>& candidates,
                                    const Vector3d& middle) {
  const double same_angle = radians_from_degrees(same_angle_deg);
  std::vector<PoseCandidate> kept_ones;
  for (const PoseCandidate& candidate : candidates) {
    const bool is_known = std::ranges::any_of(kept_ones, [&](const PoseCandidate& other) {
      const Eigen::Matrix3d between =
          other.target_from_points.linear().transpose() * candidate.target_from_points.linear();
      const Vector3d shift =
          other.target_from_points * middle - candidate.target_from_points * middle;
      return shift.norm() < same_shift && Eigen::AngleAxisd(between).angle() < same_angle;
    });
    if (!is_known) {
      kept_ones.push_back(candidate);
    }
  }
  return kept_ones;
}

}  // namespace octurn
