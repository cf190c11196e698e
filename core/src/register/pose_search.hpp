#pragma once

#include <stop_token>
#include <vector>

#include "register/free_space.hpp"
#include "register/nearest_points.hpp"

namespace octurn {

/// A pose of a turn on a target, and how well it fits.
struct PoseCandidate {
  Eigen::Isometry3d target_from_points = Eigen::Isometry3d::Identity();
  double distance = 0;       ///< metres, both ways, capped; the smaller the better
  double overlap = 0;        ///< share of the points that lie on the target
  double residual = 0;       ///< metres, root mean square of their distances
  double contradiction = 0;  ///< 0 to 2, by free space
};

/// The platforms, which tell how high a flat foot stood.
struct Stands {
  std::vector<Eigen::Isometry3d> target_from_platforms = {};  ///< of the target's turns
  std::vector<SurfacePoint> target_points = {};               ///< some of the target's
  double target_share = 1;  ///< share of all of the target's points that these are
  double share = 1;         ///< share of the turn's points that are refined
};

/// What is known of the target, or of the turn, when poses are searched; each in its own frame.
struct SearchedSide {
  const NearestPoints& nearest;
  const FreeSpace& free;
};

/// Searches the poses of a turn on a target over all rotations, about 15 degrees apart
/// (Super-Fibonacci spirals, Alexa 2022). Each begins with the middles of both on each other, and
/// is shifted by the mean way to the nearest surface until it settles.
///
/// @return the best, by the mean distance of the points of each from the surface of the other;
/// points in the other's empty space have the largest; the best first
std::vector<PoseCandidate> search_poses(const SearchedSide& target, const SearchedSide& turn,
                                        int threads, const std::stop_token& stop);

/// Refines a candidate by point-to-plane ICP, with the constraint that flat feet stand on their
/// platforms. @param points  in their platform's frame
PoseCandidate refine(const NearestPoints& target, const Stands& stands,
                     const std::vector<SurfacePoint>& points, PoseCandidate candidate,
                     int iterations);

/// Drops all but the best of candidates that are nearly the same pose.
/// @param middle  of the points
std::vector<PoseCandidate> distinct(const std::vector<PoseCandidate>& candidates,
                                    const Eigen::Vector3d& middle);

}  // namespace octurn
