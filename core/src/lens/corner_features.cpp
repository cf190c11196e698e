#include "lens/corner_features.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

namespace octurn {
namespace {

constexpr std::size_t max_features = 2000;
constexpr float min_response = 40;     // grey levels: a corner with a contrast of about 8
constexpr int ring_radius = 5;         // pixels, of the detector
constexpr int suppression_radius = 3;  // pixels, of the non-maximum suppression

struct Offset {
  int u = 0;
  int v = 0;
};

constexpr std::array<Offset, 16> ring = {{{0, -5},
                                          {2, -5},
                                          {4, -4},
                                          {5, -2},
                                          {5, 0},
                                          {5, 2},
                                          {4, 4},
                                          {2, 5},
                                          {0, 5},
                                          {-2, 5},
                                          {-4, 4},
                                          {-5, 2},
                                          {-5, 0},
                                          {-5, -2},
                                          {-4, -4},
                                          {-2, -5}}};

/// The ChESS response: sum response, less difference response and mean response (Bennett and
/// Lasenby 2014). It is large where samples on opposite sides of the ring agree, and samples a
/// quarter of a turn apart differ.
float response_at(const GreyImage& image, int u, int v) {
  std::array<float, 16> levels{};
  float sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    levels[i] = image.at(u + ring[i].u, v + ring[i].v);
    sum += levels[i];
  }
  float alike = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    alike += std::abs(levels[i] + levels[i + 8] - levels[i + 4] - levels[i + 12]);
  }
  float across = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    across += std::abs(levels[i] - levels[i + 8]);
  }
  const float middle = (image.at(u, v) + image.at(u - 1, v) + image.at(u + 1, v) +
                        image.at(u, v - 1) + image.at(u, v + 1)) /
                       5;
  return alike - across - std::abs(sum - 16 * middle);
}

bool is_maximum(const GreyImage& responses, int u, int v) {
  const float here = responses.at(u, v);
  for (int dv = -suppression_radius; dv <= suppression_radius; ++dv) {
    for (int du = -suppression_radius; du <= suppression_radius; ++du) {
      const float other = responses.at(u + du, v + dv);
      const bool is_before = dv < 0 || (dv == 0 && du < 0);
      if (other > here || (other == here && is_before)) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace

std::vector<CornerFeature> corner_features(const GreyImage& image) {
  GreyImage responses{.width = image.width,
                      .height = image.height,
                      .levels = std::vector<float>(image.levels.size(), 0.0F)};
  std::size_t pixel = 0;
  for (int v = 0; v < image.height; ++v) {
    for (int u = 0; u < image.width; ++u, ++pixel) {
      if (std::min({u, v, image.width - 1 - u, image.height - 1 - v}) >= ring_radius) {
        responses.levels[pixel] = response_at(image, u, v);
      }
    }
  }
  std::vector<CornerFeature> found;
  for (int v = ring_radius; v < image.height - ring_radius; ++v) {
    for (int u = ring_radius; u < image.width - ring_radius; ++u) {
      if (responses.at(u, v) >= min_response && is_maximum(responses, u, v)) {
        found.push_back({.pixel = Eigen::Vector2d(u, v), .response = responses.at(u, v)});
      }
    }
  }
  std::ranges::stable_sort(found, std::ranges::greater(), &CornerFeature::response);
  found.resize(std::min(found.size(), max_features));
  return found;
}

bool refine_corner(const GreyImage& image, int reach, Eigen::Vector2d& pixel) {
  constexpr int max_steps = 12;
  constexpr double small_step = 0.002;  // pixels
  const Eigen::Vector2d start = pixel;
  const double sigma = 0.55 * reach;
  for (int step = 0; step < max_steps; ++step) {
    const int u0 = static_cast<int>(std::lround(pixel.x()));
    const int v0 = static_cast<int>(std::lround(pixel.y()));
    if (std::min({u0, v0, image.width - 1 - u0, image.height - 1 - v0}) <= reach) {
      return false;
    }
    Eigen::Matrix2d matrix = Eigen::Matrix2d::Zero();
    Eigen::Vector2d right = Eigen::Vector2d::Zero();
    for (int v = v0 - reach; v <= v0 + reach; ++v) {
      for (int u = u0 - reach; u <= u0 + reach; ++u) {
        const Eigen::Vector2d way = Eigen::Vector2d(u, v) - pixel;
        const Eigen::Vector2d gradient(
            static_cast<double>(image.at(u + 1, v) - image.at(u - 1, v)),
            static_cast<double>(image.at(u, v + 1) - image.at(u, v - 1)));
        const double weight = std::exp(-way.squaredNorm() / (2 * sigma * sigma));
        matrix += weight * gradient * gradient.transpose();
        right += weight * gradient * gradient.dot(way);
      }
    }
    // On a single edge the matrix is nearly singular.
    if (matrix.determinant() < 0.02 * matrix.trace() * matrix.trace()) {
      return false;
    }
    const Eigen::Vector2d move = matrix.inverse() * right;
    pixel += move;
    if ((pixel - start).norm() > reach) {
      return false;
    }
    if (move.norm() < small_step) {
      break;
    }
  }
  return true;
}

}  // namespace octurn
