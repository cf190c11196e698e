#include "simulator/lens_distortion.hpp"

#include <cmath>

namespace octurn {

Eigen::Vector2d undistorted(const Eigen::Vector2d& shown, double k1, double k2) {
  constexpr int steps = 30;       // each leaves less than a third of the error
  constexpr double small = 1e-9;  // change of the ray: less than a millionth of a pixel
  Eigen::Vector2d ray = shown;
  for (int i = 0; i < steps; ++i) {
    const double square = ray.squaredNorm();
    const Eigen::Vector2d next = shown / (1 + square * (k1 + square * k2));
    const bool is_there = (next - ray).squaredNorm() < small * small;
    ray = next;
    if (is_there) {
      break;
    }
  }
  return ray;
}

Eigen::Vector2d ray_at(const LaserSimulation& simulation, double u, double v) {
  const Intrinsics& lens = simulation.lens;
  return undistorted({(u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy}, simulation.k1,
                     simulation.k2);
}

std::vector<std::uint8_t> distorted(std::span<const std::uint8_t> samples, std::size_t channels,
                                    const LaserSimulation& simulation) {
  const Intrinsics& lens = simulation.lens;
  const std::size_t row_samples = static_cast<std::size_t>(lens.width) * channels;
  std::vector<std::uint8_t> shown;
  shown.reserve(samples.size());
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector2d ray = ray_at(simulation, u, v);
      const double column = ray.x() * lens.fx + lens.cx;
      const double row = ray.y() * lens.fy + lens.cy;
      if (!(column >= 0 && row >= 0 && column < lens.width - 1 && row < lens.height - 1)) {
        shown.insert(shown.end(), channels, 0);
        continue;
      }
      const double across = column - std::floor(column);
      const double down = row - std::floor(row);
      const std::size_t first =
          static_cast<std::size_t>(row) * row_samples + static_cast<std::size_t>(column) * channels;
      for (std::size_t i = first; i < first + channels; ++i) {
        const double above = (1 - across) * samples[i] + across * samples[i + channels];
        const double below =
            (1 - across) * samples[i + row_samples] + across * samples[i + row_samples + channels];
        shown.push_back(static_cast<std::uint8_t>(std::lround((1 - down) * above + down * below)));
      }
    }
  }
  return shown;
}

}  // namespace octurn
