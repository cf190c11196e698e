#include "register/pose_search.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>

#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "parallel/fork_join.hpp"
#include "register/contact.hpp"
#include "register/rigid_fit.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr std::size_t rotations = 4416;
constexpr std::size_t kept = 250;
constexpr int shifts = 4;
constexpr double min_agreement = 0.6;  // cosine between two normals of one surface
constexpr double far_limit = 0.012;    // metres, at the first iterations
constexpr double near_limit = 0.004;   // at the last
constexpr int approach = 8;            // iterations from the one to the other
constexpr double cauchy_scale = 0.002;
constexpr double settled = 1e-5;      // metres
constexpr double contact_weight = 4;  // of a point of a flat foot: platforms are known well

// Two poses that are nearer are the same.
constexpr double same_angle_deg = 4;
constexpr double same_shift = 0.005;  // metres

/// The rotation of an index: evenly spread over all of them.
Eigen::Matrix3d to_rotation(std::size_t i) {
  constexpr double psi = 1.533751168755204288118041;  // psi^4 = psi + 4, as the paper has it
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

/// Shifts turned points to where the target is nearest.
PoseCandidate shifted(const NearestPoints& target, const std::vector<SurfacePoint>& points,
                      const Eigen::Matrix3d& rotation) {
  std::vector<Vector3d> turned;
  Eigen::AlignedBox3d box;
  for (const SurfacePoint& point : points) {
    turned.emplace_back(rotation * point.point);
    box.extend(turned.back());
  }
  Vector3d shift = target.middle() - box.center();
  double distance = 0;
  for (int i = 0; i <= shifts; ++i) {
    Vector3d sum = Vector3d::Zero();
    int near = 0;
    distance = 0;
    for (const Vector3d& point : turned) {
      const SurfacePoint* const nearest = target.find(point + shift);
      if (nearest == nullptr) {
        distance += NearestPoints::cap;
        continue;
      }
      const Vector3d to_nearest = nearest->point - point - shift;
      distance += std::min(to_nearest.norm(), NearestPoints::cap);
      sum += to_nearest;
      ++near;
    }
    if (i < shifts && near > 0) {
      shift += sum / near;
    }
  }
  PoseCandidate candidate;
  candidate.target_from_points.linear() = rotation;
  candidate.target_from_points.translation() = shift;
  candidate.distance = distance / static_cast<double>(points.size());
  return candidate;
}

/// Sums the distances of the points that lie within `limit` of the target.
RigidFit fit(const NearestPoints& target, const std::vector<SurfacePoint>& points,
             const Eigen::Isometry3d& pose, double limit) {
  RigidFit fit{.middle = target.middle()};
  for (const SurfacePoint& point : points) {
    const Vector3d at = pose * point.point;
    const SurfacePoint* const nearest = target.find(at);
    if (nearest == nullptr || (nearest->point - at).squaredNorm() > limit * limit ||
        nearest->normal.dot(pose.linear() * point.normal) < min_agreement) {
      continue;
    }
    const double distance = nearest->normal.dot(at - nearest->point);
    fit.add(at, nearest->normal, distance, cauchy_weight(distance, cauchy_scale));
  }
  return fit;
}

void add_contacts(RigidFit& fit, const Stands& stands, const std::vector<SurfacePoint>& points,
                  const Eigen::Isometry3d& pose) {
  for (const Eigen::Isometry3d& target_from_platform : stands.target_from_platforms) {
    const Contact foot = find_contact(points, target_from_platform.inverse() * pose, stands.share);
    add_moving_foot(fit, foot, pose, contact_weight);
  }
  const Contact foot = find_contact(stands.target_points, pose.inverse(), stands.target_share);
  add_moving_platform(fit, foot, Eigen::Isometry3d::Identity(), contact_weight);
}

}  // namespace

std::vector<PoseCandidate> search_poses(const NearestPoints& target,
                                        const std::vector<SurfacePoint>& points, int threads,
                                        const std::stop_token& stop) {
  std::vector<PoseCandidate> all(rotations);
  std::atomic<std::size_t> next = 0;
  fork_join(threads, [&](int) {
    for (std::size_t i = next++; i < all.size(); i = next++) {
      throw_if_stopped(stop);
      all[i] = shifted(target, points, to_rotation(i));
    }
  });
  std::ranges::stable_sort(all, {}, &PoseCandidate::distance);
  all.resize(kept);
  return all;
}

PoseCandidate refine(const NearestPoints& target, const Stands& stands,
                     const std::vector<SurfacePoint>& points, PoseCandidate candidate,
                     int iterations) {
  Eigen::Isometry3d& pose = candidate.target_from_points;
  for (int i = 0; i < iterations; ++i) {
    const double far = std::max(1 - static_cast<double>(i) / approach, 0.0);
    const double limit = near_limit + far * (far_limit - near_limit);
    RigidFit step = fit(target, points, pose, limit);
    add_contacts(step, stands, points, pose);
    const Eigen::Isometry3d motion = step.motion();
    pose = motion * pose;
    if (i > approach && length_of(motion, target.middle()) < settled) {
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
