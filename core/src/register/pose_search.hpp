#pragma once

#include <stop_token>
#include <vector>

#include "register/free_space.hpp"
#include "register/nearest_points.hpp"

namespace octurn {

/// A pose that was found to fit.
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
  double target_share = 1;                                    ///< that these are of all
  double share = 1;  ///< that the points which are refined are of all
};

/// What is known of the target, or of the turn, when poses are searched; each in its own frame.
struct SearchedSide {
  const NearestPoints& nearest;
  const FreeSpace& free;
};

/// Looks for poses of a turn on a target in all rotations, about 15 degrees apart (Super-Fibonacci
/// spirals, Alexa 2022), each shifted from middle on middle to where its points find the target
/// nearest (mean shift).
///
/// @return the best, by how far the points of each lie from the surface of the other, or in its
/// free space, the best first
std::vector<PoseCandidate> search_poses(const SearchedSide& target, const SearchedSide& turn,
                                        int threads, const std::stop_token& stop);

/// Refines a candidate by point-to-plane ICP, flat feet on their platforms. The points are in the
/// frame of their platform.
PoseCandidate refine(const NearestPoints& target, const Stands& stands,
                     const std::vector<SurfacePoint>& points, PoseCandidate candidate,
                     int iterations);

/// Drops all but the best of candidates that are nearly the same pose.
/// @param middle  of the points
std::vector<PoseCandidate> distinct(const std::vector<PoseCandidate>& candidates,
                                    const Eigen::Vector3d& middle);

}  // namespace octurn
