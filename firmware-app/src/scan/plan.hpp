#pragma once

#include <vector>

namespace octurn {

/// Where a scan stops: the whole microsteps nearest to equal parts of a turn, so that the turn sums
/// exactly. The first stop is the next whole turn at or after `position`, so that the platform
/// turns one way only and every scan begins at angle 0.
std::vector<int> stop_positions(int position, int steps_per_turn, int stops);

/// The angle of a position, degrees in [0, 360), counter-clockwise seen from above.
double angle_deg_at(int position, int steps_per_turn);

}  // namespace octurn
