#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "register/find_candidates.hpp"

namespace octurn {

/// The result of comparing the best candidate with the others.
struct Rivals {
  bool symmetric = false;   ///< another pose gives the same shape
  std::string reason = {};  ///< why none is accepted, for people; empty if the best one is
};

/// Whether a candidate's contradiction and residual are about as small as the best one's.
bool fits_alike(const PoseCandidate& candidate, const PoseCandidate& best);

/// Finds the rivals of the best candidate: those that fit about as well. A rival of the same shape
/// shows that the object is symmetric. A rival of another shape makes the pose ambiguous, unless
/// refinement on the readings takes both to one pose.
/// @param points      of the turn
/// @param candidates  of the turn, the best first; at least one
/// @throws Stopped  after a stop request
Rivals compare_rivals(const Target& target, const SeenTurn& turn, const NearestPoints& points,
                      const std::vector<PoseCandidate>& candidates, int threads,
                      const std::stop_token& stop);

}  // namespace octurn
