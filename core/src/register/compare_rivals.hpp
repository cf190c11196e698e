#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "register/find_candidates.hpp"

namespace octurn {

/// What the candidates beside the best one say.
struct Rivals {
  bool symmetric = false;   ///< another pose gives the same shape
  std::string reason = {};  ///< why none can be accepted, for people; or empty
};

/// Whether a candidate's contradiction and residual are about as small as the best one's.
bool fits_alike(const PoseCandidate& candidate, const PoseCandidate& best);

/// Looks for candidates that fit about as well as the best one and give another shape.
/// @param points      the turn's
/// @param candidates  of the turn, the best first; at least one
/// @throws Stopped  after a stop request
Rivals compare_rivals(const Target& target, const SeenTurn& turn, const NearestPoints& points,
                      const std::vector<PoseCandidate>& candidates, int threads,
                      const std::stop_token& stop);

}  // namespace octurn
