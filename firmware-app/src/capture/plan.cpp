#include "capture/plan.hpp"

#include <cmath>
#include <string>

#include "octurn/error.hpp"

namespace octurn {

std::vector<std::int64_t> stop_positions(std::int64_t position, int steps_per_turn, int stops,
                                         int first) {
  if (stops > steps_per_turn) {
    throw Error(ErrorCode::bad_settings,
                "a turn of the platform has " + std::to_string(steps_per_turn) + " steps, and " +
                    std::to_string(stops) + " snapshots are asked for",
                "Take fewer snapshots, or set more microsteps.",
                {{"steps", static_cast<double>(steps_per_turn)},
                 {"snapshots", static_cast<double>(stops)}});
  }
  const auto from_home = [&](std::int64_t stop) {
    const std::int64_t twice = 2 * stop * steps_per_turn / stops;
    return (twice + 1) / 2;
  };
  const std::int64_t earliest_home = position - from_home(first);
  const std::int64_t passed = earliest_home % steps_per_turn;
  const std::int64_t home = earliest_home - passed + (passed > 0 ? steps_per_turn : 0);
  std::vector<std::int64_t> positions;
  for (int stop = first; stop < stops; ++stop) {
    positions.push_back(home + from_home(stop));
  }
  return positions;
}

double angle_deg_at(std::int64_t position, int steps_per_turn) {
  const std::int64_t passed = position % steps_per_turn;
  return 360.0 * static_cast<double>(passed < 0 ? passed + steps_per_turn : passed) /
         steps_per_turn;
}

std::int64_t position_at(double angle_deg, int steps_per_turn) {
  const double turns = angle_deg / 360.0;
  return std::lround((turns - std::floor(turns)) * steps_per_turn);
}

}  // namespace octurn
