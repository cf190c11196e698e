#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octurn/lens.hpp"
#include "support/random.hpp"

namespace octurn {

/// A checkerboard in front of a camera. The renderer shares no code with the detector under test.
struct BoardScene {
  CameraLens lens = {};
  int columns = 17;  // squares
  int rows = 12;
  double side = 0.015;  // metres, of a square
  double noise = 2;     // grey levels
  double blur = 0.8;    // pixels
  double shade = 0;     // share by which the left edge is darker than the right one
  bool has_clutter = false;
};

inline CameraLens test_lens() {
  return {.intrinsics = {.width = 640, .height = 480, .fx = 540, .fy = 537, .cx = 324, .cy = 236},
          .k1 = -0.12,
          .k2 = 0.04};
}

/// Camera from board: the board's centre is at `middle` (optical frame), and it is turned about x,
/// then y, then z.
inline Eigen::Isometry3d board_at(const Eigen::Vector3d& middle, double about_x, double about_y,
                                  double about_z, const BoardScene& scene = {}) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(middle);
  pose.rotate(Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()));
  pose.rotate(Eigen::AngleAxisd(about_y, Eigen::Vector3d::UnitY()));
  pose.rotate(Eigen::AngleAxisd(about_z, Eigen::Vector3d::UnitZ()));
  pose.translate(Eigen::Vector3d(-scene.columns * scene.side / 2, -scene.rows * scene.side / 2, 0));
  return pose;
}

/// Projects a point of the optical frame to pixels.
inline Eigen::Vector2d shown(const CameraLens& lens, const Eigen::Vector3d& point) {
  const Eigen::Vector2d ray = point.hnormalized();
  const double factor = 1 + lens.k1 * ray.squaredNorm() + lens.k2 * std::pow(ray.norm(), 4);
  return {lens.intrinsics.fx * ray.x() * factor + lens.intrinsics.cx,
          lens.intrinsics.fy * ray.y() * factor + lens.intrinsics.cy};
}

/// The ray of a pixel, undistorted by fixed-point iteration.
inline Eigen::Vector2d ray_at(const CameraLens& lens, double u, double v) {
  const Eigen::Vector2d seen((u - lens.intrinsics.cx) / lens.intrinsics.fx,
                             (v - lens.intrinsics.cy) / lens.intrinsics.fy);
  Eigen::Vector2d ray = seen;
  for (int i = 0; i < 20; ++i) {
    const double square = ray.squaredNorm();
    ray = seen / (1 + lens.k1 * square + lens.k2 * square * square);
  }
  return ray;
}

/// The visible inner corners, where four squares meet, in pixels.
inline std::vector<Eigen::Vector2d> true_corners(const BoardScene& scene,
                                                 const Eigen::Isometry3d& pose) {
  std::vector<Eigen::Vector2d> corners;
  for (int row = 1; row < scene.rows; ++row) {
    for (int column = 1; column < scene.columns; ++column) {
      const Eigen::Vector2d pixel =
          shown(scene.lens, pose * Eigen::Vector3d(column * scene.side, row * scene.side, 0));
      if ((pixel.array() > 0).all() && pixel.x() < scene.lens.intrinsics.width - 1 &&
          pixel.y() < scene.lens.intrinsics.height - 1) {
        corners.push_back(pixel);
      }
    }
  }
  return corners;
}

/// Where a ray meets the board's plane, in columns and rows of squares.
inline Eigen::Vector2d intersect_board(const BoardScene& scene,
                                       const Eigen::Isometry3d& board_from_camera,
                                       const Eigen::Vector2d& ray) {
  const Eigen::Vector3d from = board_from_camera.translation();
  const Eigen::Vector3d way = board_from_camera.linear() * ray.homogeneous();
  return (from - way * (from.z() / way.z())).head<2>() / scene.side;
}

/// 1 on even columns (or rows), -1 on odd ones, and linear between them across a line between
/// squares over `width`, the extent of a pixel's sample.
inline double parity(double place, double width) {
  const double nearest = std::round(place);
  const double side = std::clamp((place - nearest) / (width / 2), -1.0, 1.0);
  return std::fmod(std::abs(nearest), 2) < 0.5 ? side : -side;
}

/// Grey level of what a ray meets: a square, the paper's margin, or the background.
/// @param width  extent of the ray's sample, in columns and rows of squares
inline double grey_level(const BoardScene& scene, const Eigen::Vector2d& met,
                         const Eigen::Vector2d& width, const Eigen::Vector2d& ray) {
  const double margin = 0.7;
  if ((met.array() < -margin).any() || met.x() > scene.columns + margin ||
      met.y() > scene.rows + margin) {
    // Bricks, some of whose corners resemble a board's corners, and a dark door.
    const bool is_brick = std::fmod(std::abs(ray.x() * 31), 2) < 1 &&
                          std::fmod(std::abs(ray.y() * 23 + std::floor(ray.x() * 31) * 0.4), 2) < 1;
    return scene.has_clutter && is_brick ? 170 : scene.has_clutter && ray.x() > 0.3 ? 25 : 90;
  }
  const bool is_board = (met.array() >= 0).all() && met.x() < scene.columns && met.y() < scene.rows;
  const double dark = (1 + parity(met.x(), width.x()) * parity(met.y(), width.y())) / 2;
  return is_board ? 205 - 175 * dark : 205;
}

inline void blur_rows(std::vector<double>& light, int width, int height, double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> blurred(light.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      double sum = 0;
      double weights = 0;
      for (int i = std::max(0, u - reach); i <= std::min(width - 1, u + reach); ++i) {
        const double weight = std::exp(-(i - u) * (i - u) / (2 * sigma * sigma));
        sum += weight * light[static_cast<std::size_t>(v * width + i)];
        weights += weight;
      }
      blurred[static_cast<std::size_t>(v * width + u)] = sum / weights;
    }
  }
  light = blurred;
}

inline std::vector<double> transposed(const std::vector<double>& light, int width, int height) {
  std::vector<double> turned(light.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      turned[static_cast<std::size_t>(u * height + v)] =
          light[static_cast<std::size_t>(v * width + u)];
    }
  }
  return turned;
}

/// Renders the scene with 3 x 3 rays a pixel, then adds blur, shade and noise.
inline Picture board_picture(const BoardScene& scene, const Eigen::Isometry3d& pose,
                             std::uint32_t seed = 1) {
  const int width = scene.lens.intrinsics.width;
  const int height = scene.lens.intrinsics.height;
  const Eigen::Isometry3d board_from_camera = pose.inverse();
  std::vector<double> light;
  std::vector<Eigen::Vector2d> rays;  // with one more row and column than the picture
  for (int v = 0; v <= height; ++v) {
    for (int u = 0; u <= width; ++u) {
      rays.push_back(ray_at(scene.lens, u, v));
    }
  }
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      const std::size_t first = static_cast<std::size_t>(v * (width + 1) + u);
      const Eigen::Vector2d here = rays[first];
      const Eigen::Vector2d right = rays[first + 1] - here;
      const Eigen::Vector2d below = rays[first + static_cast<std::size_t>(width) + 1] - here;
      const Eigen::Vector2d middle = intersect_board(scene, board_from_camera, here);
      const auto change = [&](const Eigen::Vector2d& aside) {
        return (intersect_board(scene, board_from_camera, here + aside) - middle).cwiseAbs().eval();
      };
      const Eigen::Vector2d covered = (change(right) + change(below)) / 3;
      double sum = 0;
      for (int part = 0; part < 9; ++part) {
        const Eigen::Vector2d ray =
            here + right * ((part % 3 - 1) / 3.0) + below * ((part / 3 - 1) / 3.0);
        const Eigen::Vector2d met = intersect_board(scene, board_from_camera, ray);
        sum += grey_level(scene, met, covered, ray);
      }
      light.push_back(sum / 9);
    }
  }
  if (scene.blur > 0) {
    blur_rows(light, width, height, scene.blur);
    light = transposed(light, width, height);
    blur_rows(light, height, width, scene.blur);
    light = transposed(light, height, width);
  }
  Random random(seed);
  Picture picture{.width = width, .height = height, .samples = {}};
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double across = static_cast<double>(i % static_cast<std::size_t>(width)) / width;
    const double shaded =
        light[i] * (1 - scene.shade * (1 - across)) + scene.noise * random.normal();
    picture.samples.push_back(static_cast<std::uint8_t>(std::clamp(std::lround(shaded), 0L, 255L)));
  }
  return picture;
}

}  // namespace octurn
