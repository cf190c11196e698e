#pragma once

#include <stop_token>
#include <vector>

#include "register/nearest_points.hpp"

namespace octurn {

/// A pose of a turn on a target, and how well it fits.
struct PoseCandidate {
  Eigen::Isometry3d target_from_points = Eigen::Isometry3d::Identity();
  double distance = 0;       ///< metres: sum of the mean distances in both directions
  double overlap = 0;        ///< share of the points that lie on the target
  double residual = 0;       ///< metres, root mean square of their distances
  double contradiction = 0;  ///< 0 to 2; see `RegisteredPose`
};

/// The platforms, which constrain the height of a flat foot.
struct PlatformConstraints {
  std::vector<Eigen::Isometry3d> target_from_platforms = {};  ///< of the target's turns
  std::vector<SurfacePoint> target_points = {};               ///< a subset of the target's points
  double target_share = 1;  ///< of the target's points, those in `target_points`
  double share = 1;         ///< of the turn's points, those used in the fit
};

/// One side of a search, target or turn: its points and free space, in its own frame.
struct SearchedSide {
  const NearestPoints& nearest;
  const FreeSpace& free;
};

/// Searches the poses of a turn on a target over all rotations, about 15 degrees apart
/// (Super-Fibonacci spirals, Alexa 2022). Each starts with both bounding boxes on one centre, and
/// is shifted a few times by the mean offset to the nearest surface.
///
/// @return the 100 best, sorted by the mean distance of each side's points from the other side's
/// surface; a point in the other side's free space has the maximum distance, `NearestPoints::cap`
std::vector<PoseCandidate> search_poses(const SearchedSide& target, const SearchedSide& turn,
                                        int threads, const std::stop_token& stop);

/// Refines a candidate by point-to-plane ICP, with the constraint that flat feet lie on their
/// platforms. @param points  of the turn, in its frame
PoseCandidate refine(const NearestPoints& target, const PlatformConstraints& constraints,
                     const std::vector<SurfacePoint>& points, PoseCandidate candidate,
                     int iterations);

/// Drops candidates whose pose is nearly that of an earlier one.
/// @param middle  metres: centre of the turn's points
std::vector<PoseCandidate> distinct(const std::vector<PoseCandidate>& candidates,
                                    const Eigen::Vector3d& middle);

}  // namespace octurn
