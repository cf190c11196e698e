#include "scan/plan.hpp"

#include <cstdint>

namespace octurn {

std::vector<int> stop_positions(int position, int steps_per_turn, int stops) {
  const int passed = position % steps_per_turn;
  const int home = position - passed + (passed > 0 ? steps_per_turn : 0);
  std::vector<int> positions;
  for (std::int64_t stop = 0; stop < stops; ++stop) {
    const std::int64_t twice = 2 * stop * steps_per_turn / stops;
    positions.push_back(home + static_cast<int>((twice + 1) / 2));
  }
  return positions;
}

double angle_deg_at(int position, int steps_per_turn) {
  const int passed = position % steps_per_turn;
  return 360.0 * (passed < 0 ? passed + steps_per_turn : passed) / steps_per_turn;
}

}  // namespace octurn
