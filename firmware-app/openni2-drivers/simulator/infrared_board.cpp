#include "simulator/infrared_board.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "octurn/lens.hpp"
#include "simulator/camera.hpp"
#include "simulator/lens_distortion.hpp"
#include "simulator/noise_field.hpp"
#include "simulator/printed_board.hpp"

namespace octurn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double baseline = 0.075;     // metres, from the camera to the projector
constexpr double room_inverse = 0.55;  // 1/m, of what is behind the board
constexpr double ambient = 0.1;        // of a dot's peak on paper at `usual_inverse`
constexpr double usual_inverse = 1.7;  // 1/m
constexpr double dot_size = 0.75;      // pixels, standard deviation
constexpr int dot_pitch = 3;           // pixels
constexpr float noise_level = 3;       // grey levels

constexpr std::array<BoardHold, 28> infrared_holds = {
    {{0.50, 0.50, 0.55, 0.1, 0.0, 0.0},    {0.50, 0.50, 0.58, 0.8, 0.0, 0.1},
     {0.50, 0.50, 0.58, -0.8, 0.0, 1.5},   {0.50, 0.50, 0.58, 0.0, 0.8, 0.2},
     {0.50, 0.50, 0.58, 0.0, -0.8, 1.2},   {0.24, 0.25, 0.54, 0.5, 0.5, 0.0},
     {0.76, 0.25, 0.54, 0.5, -0.5, 0.3},   {0.24, 0.75, 0.54, -0.5, 0.5, 0.0},
     {0.76, 0.75, 0.54, -0.5, -0.5, -0.2}, {0.20, 0.50, 0.54, 0.2, 0.7, 1.5},
     {0.80, 0.50, 0.54, 0.2, -0.7, 1.5},   {0.50, 0.78, 0.52, 0.7, 0.2, 0.8},
     {0.50, 0.22, 0.52, -0.7, 0.3, 0.0},   {0.52, 0.50, 0.72, 0.5, 0.5, 0.5},
     {0.57, 0.57, 0.70, -0.6, 0.4, 0.2},   {0.43, 0.57, 0.68, 0.5, -0.6, 1.0},
     {0.24, 0.25, 0.54, -0.6, -0.4, 1.5},  {0.76, 0.25, 0.54, -0.6, 0.4, 1.4},
     {0.24, 0.75, 0.54, 0.6, -0.4, 1.6},   {0.76, 0.75, 0.54, 0.6, 0.4, 1.5},
     {0.62, 0.50, 0.50, 0.8, 0.1, 0.8},    {0.38, 0.50, 0.50, -0.8, 0.1, 0.7},
     {0.50, 0.62, 0.50, 0.1, 0.85, 0.8},   {0.50, 0.38, 0.50, 0.1, -0.85, 0.7},
     {0.22, 0.20, 0.52, 0.2, 0.1, 0.1},    {0.78, 0.20, 0.52, 0.2, -0.1, -0.1},
     {0.22, 0.80, 0.52, -0.2, 0.1, -0.1},  {0.78, 0.80, 0.52, -0.2, -0.1, 0.1}}};

/// The ray of a pixel of the infrared picture.
Vector2d infrared_ray(const SensorOptics& optics, double u, double v) {
  return undistorted({(u - infrared_shift.x() - optics.cx) / optics.fx,
                      (v - infrared_shift.y() - optics.cy) / optics.fy},
                     optics.k1, optics.k2);
}

}  // namespace

Eigen::Isometry3d infrared_hold(int number, const SensorOptics& optics) {
  const BoardHold& hold =
      infrared_holds[static_cast<std::size_t>(number - 1) % infrared_holds.size()];
  const Vector2d middle =
      infrared_ray(optics, hold.across * (camera.width - 1), hold.down * (camera.height - 1));
  return camera_from_board(hold, middle);
}

InfraredBoard::InfraredBoard(const SensorOptics& optics, std::uint32_t seed)
    : optics_(optics), seed_(seed), noise_(seed) {}

/// @param u, v  pixels of the projector, whose picture has no distortion
float InfraredBoard::light_of_dots(double u, double v) const {
  constexpr float random = 0x1p-16F;
  const auto column = static_cast<int>(std::floor(u / dot_pitch));
  const auto row = static_cast<int>(std::floor(v / dot_pitch));
  float light = 0;
  for (int y = row - 1; y <= row + 1; ++y) {
    for (int x = column - 1; x <= column + 1; ++x) {
      const std::uint32_t drawn =
          mixed(mixed(seed_ + 5, static_cast<std::uint32_t>(x)), static_cast<std::uint32_t>(y));
      const float across = static_cast<float>(drawn & 0xFFFFU) * random;
      const float down = static_cast<float>(drawn >> 16U) * random;
      const float bright =
          0.5F + static_cast<float>(mixed(drawn, 1) & 0xFFFFU) * random;  // on the average, 1
      const double right = u - (static_cast<double>(x) + static_cast<double>(across)) * dot_pitch;
      const double below = v - (static_cast<double>(y) + static_cast<double>(down)) * dot_pitch;
      light += bright * static_cast<float>(
                            std::exp(-(right * right + below * below) / (2 * dot_size * dot_size)));
    }
  }
  return light;
}

void InfraredBoard::look_at(int hold) {
  hold_ = hold;
  seen_.clear();
  seen_.reserve(pixels(camera));
  const Eigen::Isometry3d held =
      hold > 0 ? infrared_hold(hold, optics_) : Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d board_from_camera = held.inverse();
  const Vector3d normal = held.linear().col(2);
  const double plane = normal.dot(held.translation()) * board_square;
  const Vector2d pixel(1 / optics_.fx, 1 / optics_.fy);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Vector2d ray = infrared_ray(optics_, u, v);
      double inverse_depth = room_inverse;
      double level = 92;  // of the room
      if (hold > 0) {
        const Vector2d met = intersect_board(board_from_camera, ray);
        level = board_light(board_from_camera, ray, met, pixel);
        inverse_depth = is_on_board(met) ? normal.dot(ray.homogeneous()) / plane : room_inverse;
      }
      const double near = std::pow(inverse_depth / usual_inverse, 2);
      const float dots =
          light_of_dots(optics_.fx * (ray.x() + baseline * inverse_depth), optics_.fy * ray.y());
      seen_.push_back(static_cast<float>(level * near) * (static_cast<float>(ambient) + dots));
    }
  }
}

void InfraredBoard::expose(int hold, std::uint32_t frame, std::span<std::uint8_t> picture) {
  if (hold != hold_) {
    look_at(hold);
  }
  const std::uint32_t of_frame = mixed(seed_ + 6, frame);
  for (std::size_t row = 0; row < static_cast<std::size_t>(camera.height); ++row) {
    const std::uint32_t sequence = mixed(of_frame, static_cast<std::uint32_t>(row));
    const std::size_t first = row * static_cast<std::size_t>(camera.width);
    for (std::size_t u = 0; u < static_cast<std::size_t>(camera.width); ++u) {
      const float level = seen_[first + u] + noise_level * noise_.at(sequence, u);
      picture[first + u] = static_cast<std::uint8_t>(std::clamp(level, 0.0F, 255.0F));
    }
  }
}

}  // namespace octurn
