#pragma once

#include <stop_token>
#include <vector>

#include "register/pose_search.hpp"
#include "register/reading_fit.hpp"

namespace octurn {

/// What all placed turns saw, in the object's frame.
struct Target {
  std::vector<PlacedTurn> turns;
  NearestPoints points;
};

Target make_target(std::vector<PlacedTurn> turns);

/// Looks for the poses of a turn that fit, in all rotations, each refined and judged by free space.
/// @param points  what the turn saw
/// @return the distinct ones, the least contradicted first
/// @throws Stopped
std::vector<PoseCandidate> find_candidates(const Target& target, const SeenTurn& turn,
                                           const NearestPoints& points, int threads,
                                           const std::stop_token& stop);

/// Refines and judges one pose of a turn, which is right to a centimetre and some 15 degrees.
/// @param start  object's frame from the turn's
PoseCandidate refine_candidate(const Target& target, const SeenTurn& turn,
                               const Eigen::Isometry3d& start);

/// The first few candidates, of those that give the same shape the first.
/// @param turn  what the turn saw
std::vector<PoseCandidate> without_same_shapes(const std::vector<PoseCandidate>& candidates,
                                               const Target& target, const NearestPoints& turn);

}  // namespace octurn
