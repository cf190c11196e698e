#include "scan/plan.hpp"

#include <cmath>
#include <cstdint>

namespace octurn {

std::vector<int> stop_positions(int position, int steps_per_turn, int stops, int first) {
  const auto from_home = [&](std::int64_t stop) {
    const std::int64_t twice = 2 * stop * steps_per_turn / stops;
    return static_cast<int>((twice + 1) / 2);
  };
  const int earliest_home = position - from_home(first);
  const int passed = earliest_home % steps_per_turn;
  const int home = earliest_home - passed + (passed > 0 ? steps_per_turn : 0);
  std::vector<int> positions;
  for (int stop = first; stop < stops; ++stop) {
    positions.push_back(home + from_home(stop));
  }
  return positions;
}

double angle_deg_at(int position, int steps_per_turn) {
  const int passed = position % steps_per_turn;
  return 360.0 * (passed < 0 ? passed + steps_per_turn : passed) / steps_per_turn;
}

int position_at(double angle_deg, int steps_per_turn) {
  const double turns = angle_deg / 360.0;
  return static_cast<int>(std::lround((turns - std::floor(turns)) * steps_per_turn));
}

}  // namespace octurn
