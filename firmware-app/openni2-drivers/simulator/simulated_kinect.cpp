#include "simulator/simulated_kinect.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "simulator/camera.hpp"

namespace octurn {
namespace {

constexpr int blind_columns =
    8;  // at the right edge, where the correlation window leaves the picture

// Parts of the noise field that no frame draws from.
enum Part : std::uint32_t { pattern_part, edge_u_part, edge_v_part, loss_part, parts };

constexpr float fixed_share =
    0.2F;  // of the noise's variance, constant while the scene stands still
constexpr float never_lost = 1e9F;

/// Noise moves edges by this many pixels (standard deviation), and by `longest_move` at most.
constexpr float edge_move = 1.2F;
constexpr int longest_move = 7;

std::size_t index(int u, int v) { return static_cast<std::size_t>(v * camera.width + u); }

/// Standard deviation of one reading, a fit to the residuals of planes in real frames: tables seen
/// at 43 to 71 degrees from 0.65 to 1.35 m, and nearly head-on at 0.84 m. Incidence matters little,
/// less than in Nguyen, Izadi and Lovell 2012, "Modeling Kinect Sensor Noise".
float to_noise_factor(const Surface& surface) {
  const float at_depth = 0.47F + 0.14F * surface.inverse_depth * surface.inverse_depth;
  const float tangent_squared = 1 / (surface.cosine * surface.cosine) - 1;
  return at_depth * (1 + 0.02F * tangent_squared);
}

/// The noise above which a pixel has no depth, standard deviations.
float to_loss_threshold(const Surface& surface) {
  constexpr float usual = 4.5F;
  constexpr float at_edge = 1.4F;       // a twelfth of the pixels there is lost
  constexpr float hardly_seen = 0.22F;  // cosine of 77 degrees: from there on pixels are lost,
  constexpr float unseen = 0.10F;       // all of them at 84 degrees
  const float grazing = usual * (2 * (surface.cosine - unseen) / (hardly_seen - unseen) - 1);
  return std::min({usual, grazing, surface.is_edge ? at_edge : usual});
}

}  // namespace

SimulatedKinect::SimulatedKinect(Scene scene, std::uint32_t seed, double noise, double pattern)
    : scene_(std::move(scene)),
      seed_(seed),
      noise_(static_cast<float>(noise)),
      field_(seed),
      pattern_(seed, pattern),
      depth_table_(depth_of_readings()),
      lit_(scene_.lit_at(angle_)),
      pixels_(pixels(camera)) {
  update_pixels({.left = 0, .top = 0, .right = camera.width, .bottom = camera.height});
}

void SimulatedKinect::expose(double angle, std::uint32_t frame, std::span<std::uint16_t> depth) {
  assert(depth.size() == pixels(camera));
  if (angle != angle_) {
    angle_ = angle;
    look_again();
  }
  const std::uint32_t noise_part = mixed(seed_, parts + 2 * frame);
  const std::uint32_t lost_part = mixed(seed_, parts + 2 * frame + 1);
  for (int v = 0; v < camera.height; ++v) {
    const auto noise = field_.row(noise_part, v);
    const auto loss = field_.row(lost_part, v);
    const Pixel* row = &pixels_[index(0, v)];
    std::uint16_t* out = &depth[index(0, v)];
    for (std::size_t u = 0; u < camera.width; ++u) {
      const float reading = row[u].reading + row[u].spread * static_cast<float>(noise[u]);
      const auto rounded =
          static_cast<int>(std::clamp(reading + 0.5F, 0.0F, static_cast<float>(no_reading)));
      const bool is_lost = static_cast<float>(loss[u]) > row[u].loss_threshold;
      out[u] = is_lost ? std::uint16_t{0} : depth_table_[static_cast<std::size_t>(rounded)];
    }
  }
}

void SimulatedKinect::turn_to_wall(double distance) {
  if (distance != wall_) {
    wall_ = distance;
    look_again();
  }
}

void SimulatedKinect::show_board(int hold) {
  if (hold != board_) {
    board_ = hold;
    look_again();
  }
}

void SimulatedKinect::expose_infrared(std::uint32_t frame, std::span<std::uint8_t> picture) {
  if (!infrared_) {
    infrared_.emplace(scene_.optics(), seed_);
  }
  infrared_->expose(board_, frame, picture);
}

void SimulatedKinect::set_object_pose(int pose) {
  if (scene_.set_object_pose(pose)) {
    look_again();
  }
}

void SimulatedKinect::look_again() {
  const InverseDepth before =
      std::exchange(lit_, board_ > 0  ? Scene::of_board(board_, scene_.optics()).lit_at(0)
                          : wall_ > 0 ? Scene::of_wall(wall_, scene_.optics()).lit_at(0)
                                      : scene_.lit_at(angle_));
  update_pixels(changed_from(before));
}

/// The smallest rectangle around all pixels that may have changed.
SimulatedKinect::Rectangle SimulatedKinect::changed_from(const InverseDepth& before) const {
  Rectangle changed = {.left = camera.width, .top = camera.height, .right = 0, .bottom = 0};
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      if (lit_[index(u, v)] != before[index(u, v)]) {
        changed = {.left = std::min(changed.left, u),
                   .top = std::min(changed.top, v),
                   .right = std::max(changed.right, u + 1),
                   .bottom = v + 1};
      }
    }
  }
  constexpr int margin = longest_move + 1;
  return {.left = std::max(changed.left - margin, 0),
          .top = std::max(changed.top - margin, 0),
          .right = std::min(changed.right + margin, camera.width),
          .bottom = std::min(changed.bottom + margin, camera.height)};
}

void SimulatedKinect::update_pixels(const Rectangle& part) {
  const InverseDepth depth = noise_ > 0 ? with_ragged_edges(part) : lit_;
  for (int v = part.top; v < part.bottom; ++v) {
    for (int u = part.left; u < part.right; ++u) {
      const float seen = depth[index(u, v)];
      Pixel& pixel = pixels_[index(u, v)];
      if (seen <= 0 || u >= camera.width - blind_columns) {
        pixel = {.reading = no_reading, .loss_threshold = never_lost};
      } else if (noise_ <= 0) {
        pixel = {.reading = to_reading(seen) + pattern_.error(index(u, v), seen),
                 .loss_threshold = never_lost};
      } else {
        pixel = noisy(surface_at(depth, u, v), u, v);
      }
    }
  }
}

/// At an edge, takes the surface a pixel or two aside, as a correlation window that straddles the
/// edge does.
InverseDepth SimulatedKinect::with_ragged_edges(const Rectangle& part) const {
  InverseDepth ragged = lit_;
  const float scale = edge_move * std::min(noise_, 1.0F) / NoiseField::one;
  const auto moved = [scale](int from, std::int8_t noise, int size) {
    const auto move = static_cast<int>(std::lround(scale * static_cast<float>(noise)));
    return std::clamp(from + std::clamp(move, -longest_move, longest_move), 0, size - 1);
  };
  for (int v = part.top; v < part.bottom; ++v) {
    const auto aside = field_.row(mixed(seed_, edge_u_part), v);
    const auto down = field_.row(mixed(seed_, edge_v_part), v);
    for (int u = part.left; u < part.right; ++u) {
      const auto column = static_cast<std::size_t>(u);
      const float found =
          lit_[index(moved(u, aside[column], camera.width), moved(v, down[column], camera.height))];
      if (is_edge(found, lit_[index(u, v)])) {
        ragged[index(u, v)] = found;
      }
    }
  }
  return ragged;
}

SimulatedKinect::Pixel SimulatedKinect::noisy(const Surface& surface, int u, int v) const {
  const float ideal = to_reading(surface.inverse_depth);
  const float spread = noise_ * to_noise_factor(surface);
  // A reading is the pattern's shift to the left, in eighths of a pixel.
  const auto found = static_cast<std::size_t>(u + static_cast<int>(ideal) / 8) % 512;
  const auto pattern = static_cast<float>(field_.row(mixed(seed_, pattern_part), v)[found]);
  const auto loss =
      static_cast<float>(field_.row(mixed(seed_, loss_part), v)[static_cast<std::size_t>(u)]);
  const float fixed = std::sqrt(fixed_share);
  const float fresh = std::sqrt(1 - fixed_share);
  return {.reading = ideal + pattern_.error(index(u, v), surface.inverse_depth) +
                     fixed * spread * pattern / NoiseField::one,
          .spread = fresh * spread / NoiseField::one,
          .loss_threshold =
              (NoiseField::one * to_loss_threshold(surface) / noise_ - fixed * loss) / fresh};
}

std::vector<std::uint16_t> depth_of_readings() {
  constexpr double nearest = 4500;    // tenths of a millimetre; real frames begin at 464 mm
  constexpr double farthest = 65534;  // recordings lose the largest value, 65535
  std::vector<std::uint16_t> depths(no_reading + 1, 0);
  for (int reading = 0; reading < no_reading; ++reading) {
    const double depth = 1e4 * static_cast<double>(readings_times_metres) /
                         (static_cast<double>(reading_at_infinity) - reading);
    if (depth >= nearest && depth <= farthest) {
      depths[static_cast<std::size_t>(reading)] = static_cast<std::uint16_t>(std::lround(depth));
    }
  }
  return depths;
}

}  // namespace octurn
