#pragma once

#include <stop_token>
#include <vector>

#include "build/merged_scan.hpp"

namespace octurn {

/// Solves the sensor's pose for each turn without a solved one, from its snapshots, once. The
/// configured pose stays if the solution is refused or confirms it. A turn that is registered
/// already keeps the pose with which it was. Turns of one rig share the mean of their solved poses.
void solve_rigs(std::vector<StoredTurn>& turns, int threads, const std::stop_token& stop);

}  // namespace octurn
