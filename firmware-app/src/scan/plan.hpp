#pragma once

#include <cstdint>
#include <vector>

namespace octurn {

/// The stops of a scan: whole microsteps nearest to equal parts of a turn, so that they sum to a
/// turn exactly. Stop 0 is at angle 0. The platform turns in one direction only: the first stop is
/// at or after `position`.
///
/// @param first  the first stop that is still to be made
/// @throws Error "bad-settings"  if a turn has fewer steps than stops
std::vector<std::int64_t> stop_positions(std::int64_t position, int steps_per_turn, int stops,
                                         int first = 0);

/// The angle of a position, degrees in [0, 360), counter-clockwise seen from above.
double angle_deg_at(std::int64_t position, int steps_per_turn);

/// The position in the first turn that is nearest to an angle, degrees.
std::int64_t position_at(double angle_deg, int steps_per_turn);

}  // namespace octurn
