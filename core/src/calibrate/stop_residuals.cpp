#include "calibrate/stop_residuals.hpp"

#include <cmath>
#include <utility>

#include "calibrate/for_each_stop.hpp"
#include "calibrate/median.hpp"

namespace octurn {

double median_residual(const TurnViews& turn, const Eigen::Isometry3d& platform_from_sensor,
                       const std::vector<double>& stop_offsets, int threads) {
  std::vector<std::vector<float>> of_stops(turn.views.size());
  for_each_stop(of_stops.size(), threads, [&](std::size_t stop) {
    for_each_residual(turn, platform_from_sensor, stop_offsets, stop, {},
                      [&](const StopResidual& residual) {
                        of_stops[stop].push_back(static_cast<float>(std::abs(residual.distance)));
                      });
  });
  std::vector<float> all;
  for (const std::vector<float>& some : of_stops) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return median(std::move(all));
}

}  // namespace octurn
