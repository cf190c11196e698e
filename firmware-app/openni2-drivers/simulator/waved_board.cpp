#include "simulator/waved_board.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "simulator/lens_distortion.hpp"
#include "simulator/noise_field.hpp"
#include "simulator/printed_board.hpp"

namespace octurn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double fall_off = 0.35;    // of the light, from the right to the left
constexpr float noise_level = 1.2F;  // grey levels

constexpr int still_pictures = 5;
constexpr int moving_pictures = 2;

constexpr std::array<BoardHold, 14> holds = {{{0.5, 0.5, 0.32, 0.05, 0.02, 0.0},
                                              {0.45, 0.5, 0.34, 0.5, 0.0, 0.1},
                                              {0.55, 0.5, 0.34, -0.5, 0.05, 1.5},
                                              {0.5, 0.45, 0.34, 0.0, 0.55, 0.2},
                                              {0.5, 0.55, 0.34, 0.1, -0.55, 1.2},
                                              {0.25, 0.25, 0.28, 0.3, 0.25, 0.0},
                                              {0.75, 0.25, 0.28, 0.3, -0.25, 0.1},
                                              {0.25, 0.75, 0.28, -0.3, 0.25, 0.05},
                                              {0.75, 0.75, 0.28, -0.3, -0.25, -0.1},
                                              {0.2, 0.5, 0.24, 0.1, 0.3, 1.5},
                                              {0.8, 0.5, 0.24, 0.1, -0.3, 1.6},
                                              {0.5, 0.2, 0.22, 0.25, 0.1, 0.0},
                                              {0.5, 0.8, 0.22, -0.25, 0.1, 0.1},
                                              {0.5, 0.5, 0.42, 0.4, 0.4, 0.7}}};

BoardHold between(const BoardHold& one, const BoardHold& other, double share) {
  const auto mix = [share](double a, double b) { return a + share * (b - a); };
  return {.across = mix(one.across, other.across),
          .down = mix(one.down, other.down),
          .distance = mix(one.distance, other.distance),
          .about_x = mix(one.about_x, other.about_x),
          .about_y = mix(one.about_y, other.about_y),
          .about_z = mix(one.about_z, other.about_z)};
}

BoardHold hold_at(int number) {
  constexpr int of_one = still_pictures + moving_pictures;
  const auto index = static_cast<std::size_t>(number / of_one);
  const int within = number % of_one;
  const BoardHold& now = holds[index % holds.size()];
  const BoardHold& next = holds[(index + 1) % holds.size()];
  const double share = std::max(0, within - still_pictures + 1) / (moving_pictures + 1.0);
  return between(now, next, share);
}

}  // namespace

WavedBoard::WavedBoard(const LaserSimulation& simulation)
    : simulation_(simulation), noise_(simulation.seed) {
  const Intrinsics& lens = simulation.lens;
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      rays_.push_back(ray_at(simulation, u, v));
    }
  }
}

Picture WavedBoard::picture(int number) const {
  const Intrinsics& lens = simulation_.lens;
  const BoardHold hold = hold_at(number);
  const Vector2d middle =
      ray_at(simulation_, hold.across * (lens.width - 1), hold.down * (lens.height - 1));
  const Eigen::Isometry3d board_from_camera = camera_from_board(hold, middle).inverse();
  const Vector2d pixel(1 / lens.fx, 1 / lens.fy);
  Picture picture{.width = lens.width, .height = lens.height, .samples = {}};
  picture.samples.reserve(static_cast<std::size_t>(lens.width) *
                          static_cast<std::size_t>(lens.height));
  const std::uint32_t of_picture = mixed(simulation_.seed + 2, static_cast<std::uint32_t>(number));
  for (int v = 0; v < lens.height; ++v) {
    const std::uint32_t sequence = mixed(of_picture, static_cast<std::uint32_t>(v));
    for (int u = 0; u < lens.width; ++u) {
      const Vector2d& ray = rays_[picture.samples.size()];
      const Vector2d met = intersect_board(board_from_camera, ray);
      const double shade = 1 - fall_off * (1 - static_cast<double>(u) / lens.width);
      const auto grain =
          static_cast<double>(noise_level * noise_.at(sequence, static_cast<std::size_t>(u)));
      picture.samples.push_back(static_cast<std::uint8_t>(std::clamp(
          std::lround(shade * board_light(board_from_camera, ray, met, pixel) + grain), 0L, 255L)));
    }
  }
  return picture;
}

}  // namespace octurn
