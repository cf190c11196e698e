#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "depth/depth_limits.hpp"
#include "io/radial_distortion.hpp"
#include "octurn/lens.hpp"
#include "octurn/median.hpp"
#include "octurn/sensor_map.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double max_dotted_rms = 1;    // pixels: a bent board or one that moved shows more
constexpr int depth_reach = 4;          // pixels about a corner
constexpr int min_block_readings = 40;  // of the 81 there
constexpr std::size_t min_depth_views = 5;
constexpr double max_scale_error = 0.1;
constexpr double board_sigma = 0.002;  // of a printed board's squares, which a ruler measured
constexpr double offset_sigma = 0.01;  // 1/m, of the prior
constexpr double shift_sigma = 1;      // pixels, of the prior
constexpr int depth_steps = 4;
constexpr double outlier_factor = 4;  // times the median residual's sigma
/// Neighbouring depths share the sensor's fixed pattern, which is correlated over some 50 pixels: a
/// view of 12 by 17 squares has a dozen depths for each part of it, and views overlap.
constexpr double correlated_depths = 30;

/// Scale and offset of reported depths, and the infrared picture's shift.
struct DepthModel {
  double scale = 1;
  double offset = 0;  // 1/m
  Vector2d shift = infrared_shift;
};

/// The inverse depth of a board along a pixel's ray.
/// @param pixel  of the infrared picture  @param side  metres
double board_inverse_depth(const CameraLens& lens, const Eigen::Isometry3d& camera_from_board,
                           const Vector2d& pixel, double side) {
  const Intrinsics& in = lens.intrinsics;
  const Vector2d shown((pixel.x() - in.cx) / in.fx, (pixel.y() - in.cy) / in.fy);
  const RadialDistortion distortion{.k1 = lens.k1, .k2 = lens.k2};
  const Vector2d ray = shown * distortion.undistorting_factor(shown.norm());
  const Vector3d normal = camera_from_board.linear().col(2);
  return normal.dot(ray.homogeneous()) / (normal.dot(camera_from_board.translation()) * side);
}

/// A depth and the place of its board.
struct BoardReading {
  BoardDepth depth = {};
  const Eigen::Isometry3d* camera_from_board = nullptr;
};

struct ReadingResidual {
  double residual = 0;
  Vector4d row = Vector4d::Zero();  // its derivatives by scale, offset and shift, negated
};

ReadingResidual compare(const BoardReading& reading, const CameraLens& lens,
                        const DepthModel& model, double side) {
  const auto truth = [&](const Vector2d& aside) {
    return board_inverse_depth(lens, *reading.camera_from_board,
                               reading.depth.pixel + model.shift + aside, side);
  };
  const double here = truth(Vector2d::Zero());
  const double right = truth(Vector2d(0.5, 0)) - truth(Vector2d(-0.5, 0));
  const double below = truth(Vector2d(0, 0.5)) - truth(Vector2d(0, -0.5));
  return {.residual = reading.depth.inverse_depth - (model.scale * here - model.offset),
          .row = Vector4d(here, -1, model.scale * right, model.scale * below)};
}

struct DepthFit {
  DepthModel model = {};
  Vector4d sigma = Vector4d::Zero();
  double rms = 0;  // 1/m
  int used = 0;
};

/// One step of Gauss-Newton, with the residuals that are no outliers.
/// @return nullopt  if the readings do not determine the model
std::optional<DepthFit> step(const std::vector<BoardReading>& readings, const CameraLens& lens,
                             const DepthModel& from, double side) {
  std::vector<ReadingResidual> residuals;
  std::vector<double> sizes;
  for (const BoardReading& reading : readings) {
    residuals.push_back(compare(reading, lens, from, side));
    sizes.push_back(std::abs(residuals.back().residual));
  }
  const double limit = outlier_factor * std::max(1.5 * median(sizes), disparity_unit / 10);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  Vector4d right = Vector4d::Zero();
  DepthFit fit;
  for (const ReadingResidual& one : residuals) {
    if (std::abs(one.residual) < limit) {
      matrix += one.row * one.row.transpose();
      right += one.row * one.residual;
      fit.rms += one.residual * one.residual;
      ++fit.used;
    }
  }
  const double variance = fit.rms / std::max(1, fit.used);
  fit.rms = std::sqrt(variance);
  const double information = 1 / (correlated_depths * std::max(variance, 1e-12));
  matrix *= information;
  right *= information;
  const Vector4d prior(0, std::pow(offset_sigma, -2), std::pow(shift_sigma, -2),
                       std::pow(shift_sigma, -2));
  const Vector2d moved = from.shift - infrared_shift;
  matrix.diagonal() += prior;
  right -= prior.cwiseProduct(Vector4d(0, from.offset, moved.x(), moved.y()));
  const auto solved = solve_symmetric(matrix, right);
  if (!solved) {
    return std::nullopt;
  }
  fit.model = {.scale = from.scale + solved->values[0],
               .offset = from.offset + solved->values[1],
               .shift = from.shift + solved->values.tail<2>()};
  fit.sigma = solved->inverse.diagonal().cwiseSqrt();
  return fit;
}

void refuse(LensReport& report, const char* reason) {
  report.accepted = false;
  report.reason = reason;
}

SolvedOptics to_optics(const LensReport& lens, const DepthFit& fit) {
  const Intrinsics& in = lens.lens.intrinsics;
  const Intrinsics& sigma = lens.sigma.intrinsics;
  // The boards' distances are as uncertain as the focal length, which they are proportional to.
  const double focal = std::hypot(sigma.fx / in.fx, sigma.fy / in.fy) / std::sqrt(2.0);
  return {.value = {.fx = in.fx,
                    .fy = in.fy,
                    .cx = in.cx - fit.model.shift.x(),
                    .cy = in.cy - fit.model.shift.y(),
                    .k1 = lens.lens.k1,
                    .k2 = lens.lens.k2,
                    .depth_scale = fit.model.scale,
                    .depth_offset_per_m = fit.model.offset},
          .sigma = {.fx = sigma.fx,
                    .fy = sigma.fy,
                    .cx = std::hypot(sigma.cx, fit.sigma[2]),
                    .cy = std::hypot(sigma.cy, fit.sigma[3]),
                    .k1 = lens.sigma.k1,
                    .k2 = lens.sigma.k2,
                    .depth_scale = std::hypot(fit.sigma[0], focal, board_sigma),
                    .depth_offset_per_m = fit.sigma[1]}};
}

}  // namespace

std::vector<BoardDepth> board_depths(const BoardView& corners, const DepthFrame& frame,
                                     const Intrinsics& sensor) {
  check_size(frame, sensor, "board_depths");
  std::vector<BoardDepth> depths;
  for (const BoardCorner& corner : corners) {
    const Vector2d middle = corner.pixel - infrared_shift;
    const int left = static_cast<int>(std::lround(middle.x())) - depth_reach;
    const int top = static_cast<int>(std::lround(middle.y())) - depth_reach;
    BoardDepth mean;
    int count = 0;
    for (int v = std::max(0, top); v <= std::min(top + 2 * depth_reach, frame.height - 1); ++v) {
      for (int u = std::max(0, left); u <= std::min(left + 2 * depth_reach, frame.width - 1); ++u) {
        const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
                           static_cast<std::size_t>(u);
        if (frame.depth[pixel] > 0) {
          mean.pixel += Vector2d(u, v);
          mean.inverse_depth += 1 / (frame.depth[pixel] * sensor.depth_unit);
          ++count;
        }
      }
    }
    if (count >= min_block_readings) {
      depths.push_back({.pixel = mean.pixel / count, .inverse_depth = mean.inverse_depth / count});
    }
  }
  return depths;
}

DepthOpticsReport calibrate_depth_optics(std::span<const DepthBoardView> views, int width,
                                         int height, double side) {
  std::vector<BoardView> boards;
  for (const DepthBoardView& view : views) {
    boards.push_back(view.corners);
  }
  DepthOpticsReport report{
      .lens = calibrate_lens(boards, width, height,
                             {.shape = PixelShape::square, .max_rms = max_dotted_rms})};
  std::vector<BoardReading> readings;
  std::size_t with_depths = 0;
  for (const FoundBoard& board : report.lens.boards) {
    const std::vector<BoardDepth>& depths = views[board.view].depths;
    with_depths += depths.empty() ? 0 : 1;
    for (const BoardDepth& depth : depths) {
      readings.push_back({.depth = depth, .camera_from_board = &board.camera_from_board});
    }
  }
  if (!report.lens.accepted) {
    return report;
  }
  if (with_depths < min_depth_views) {
    refuse(report.lens, "the sensor measured the board's depth in fewer than 5 places");
    return report;
  }
  std::optional<DepthFit> fit = DepthFit{};
  for (int i = 0; i < depth_steps && fit; ++i) {
    fit = step(readings, report.lens.lens, fit->model, side);
  }
  if (!fit || !(std::abs(fit->model.scale - 1) <= max_scale_error)) {  // also if it is no number
    refuse(report.lens,
           "the board's squares have another size than told, or the sensor's depths are more "
           "than 10 % off");
    return report;
  }
  report.optics = to_optics(report.lens, *fit);
  report.shift = fit->model.shift;
  report.depth_rms = fit->rms;
  report.depths = fit->used;
  return report;
}

}  // namespace octurn
