#pragma once

#include <stop_token>
#include <vector>

#include "register/pose_search.hpp"
#include "register/reading_fit.hpp"

namespace octurn {

/// The placed turns, and the points of all of them in the object's frame.
struct Target {
  std::vector<PlacedTurn> turns;
  NearestPoints points;
};

Target make_target(std::vector<PlacedTurn> turns);

/// Searches all rotations for poses in which a turn fits. Each is refined and ranked by free space.
/// @param points  of the turn
/// @return distinct candidates, the least contradicted first; where contradictions are about equal,
/// the smallest residual first
/// @throws Stopped
std::vector<PoseCandidate> find_candidates(const Target& target, const SeenTurn& turn,
                                           const NearestPoints& points, int threads,
                                           const std::stop_token& stop);

/// Refines an estimate of a turn's pose, and measures its contradiction.
/// @param start  frame of the turn to the object's frame, within a centimetre and some 15 degrees
PoseCandidate refine_candidate(const Target& target, const SeenTurn& turn,
                               const Eigen::Isometry3d& start);

/// Returns the first candidate of each shape, at most five.
/// @param turn  points of the turn
std::vector<PoseCandidate> without_same_shapes(const std::vector<PoseCandidate>& candidates,
                                               const Target& target, const NearestPoints& turn);

}  // namespace octurn
