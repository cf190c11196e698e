#pragma once

#include <cstdint>
#include <vector>

namespace octurn {

/// Returns the positions of a scan's stops, microsteps. They divide a turn into equal parts; each
/// is rounded by itself, so that rounding errors do not add up. Stop 0 is at angle 0. The platform
/// turns in one direction only: the first position is at or after `position`.
///
/// @param first  index of the first stop to make; above 0 for a resumed scan
/// @throws Error "bad-settings"  if a turn has fewer steps than stops
std::vector<std::int64_t> stop_positions(std::int64_t position, int steps_per_turn, int stops,
                                         int first = 0);

/// Returns the angle of a position, degrees in [0, 360), counter-clockwise seen from above.
double angle_deg_at(std::int64_t position, int steps_per_turn);

/// Returns the position nearest to an angle, in the first turn. @param angle_deg  any
std::int64_t position_at(double angle_deg, int steps_per_turn);

}  // namespace octurn
