#include "calibrate/optics_solver.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "calibrate/normal_equations.hpp"
#include "calibrate/platform_plane.hpp"
#include "depth/pinhole.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/units.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Unknowns: the axis as in `axis_row`, the platform's height and its tilt against the axis, the
// focal length's relative change, the principal point's in pixels, and k1's.
constexpr int height_at = 4;
constexpr int tilt_at = 5;
constexpr int optics_at = 7;
constexpr int optics_count = 4;
constexpr int optics_unknowns = optics_at + optics_count;
using UnknownVector = Eigen::Matrix<double, optics_unknowns, 1>;
using UnknownMatrix = Eigen::Matrix<double, optics_unknowns, optics_unknowns>;
using Optics = Eigen::Matrix<double, optics_count, 1>;
using OpticsMotion = Eigen::Matrix<double, 3, optics_count>;

// Most need three or four iterations, and a sensor whose principal point is far off up to eight.
constexpr int max_optics_steps = 10;
constexpr ResidualLimits first_limits{.max_distance = 0.01, .cauchy_scale = 0.003};
constexpr ResidualLimits later_limits{.max_distance = 0.005, .cauchy_scale = 0.002};

/// Sigmas of a data sheet's optics: the spread of published Kinects.
const Optics unit_spread(0.015, 8, 8, 0.08);
/// Between two turns optics drift with the sensor's temperature, and the object's shape biases
/// them.
const Optics turn_spread(0.001, 0.7, 0.7, 0.01);
/// By how far a pattern that no map corrects misplaces the focal length, for each unit of its
/// disparity: patterns of 0.8 units by 0.8 % (root mean square of 32 scans, 2 % at most).
constexpr double focal_sigma_of_pattern = 0.01;
constexpr double usual_pattern = 0.8;  // the platform shows less of it, as its plane follows it
constexpr double held_sigma = 1e-6;    // of optics that are held: far below what any turn shows
constexpr double better_sigma = 0.7;   // of a known sigma: the turn tells more than was known
/// The share of a length by which the object is sheared, of a wrong principal point's share of the
/// focal length; roughly: on a bunny, 11 pixels of 576 cost 0.3 mm in 160 mm.
constexpr double shear_of_centre = 0.1;
// Of what no turn tells: it stays as the sensor tells it.
constexpr double k2_sigma = 0.1;
constexpr double depth_offset_sigma = 0.003;  // 1/m: a step of disparity
constexpr double square_sigma_deg = 0.05;     // of the platform's tilt against its axis
// Samples of the platform, one in 4 x 4 pixels, that share the sensor's fixed error: its pattern is
// 50 pixels wide.
constexpr double correlated_samples = 490;
constexpr double min_unevenness = 0.15;      // units of disparity
constexpr double max_platform_residual = 6;  // the object's foot, or the rim
// Metres, of each residual: edges and grazing angles err in the same way at all stops.
constexpr double systematic = 3e-5;
constexpr double reading_height = 0.0025;  // metres above the platform, of the object's readings
constexpr double max_focal_change = 0.2;   // of the focal length, in one iteration
constexpr double settled_optics = 1e-5;    // metres, of the axis: `calibrate` wants no more

/// A pixel whose readings at all stops are the platform's.
struct PlatformPixel {
  int u = 0;
  int v = 0;
  double inverse_depth = 0;  // 1/m, mean
};

std::vector<PlatformPixel> platform_pixels(const PlatformSamples& samples,
                                           const PlatformPlane& plane) {
  const std::vector<bool> is_plane = find_plane_pixels(samples, plane);
  std::vector<PlatformPixel> pixels;
  for (std::size_t i = 0; i < is_plane.size(); ++i) {
    if (!is_plane[i]) {
      continue;
    }
    double sum = 0;
    double count = 0;
    for (const std::vector<float>& depths : samples.depths) {
      if (depths[i] > 0) {
        sum += 1 / static_cast<double>(depths[i]);
        ++count;
      }
    }
    pixels.push_back({.u = static_cast<int>(i % samples.columns) * platform_step,
                      .v = static_cast<int>(i / samples.columns) * platform_step,
                      .inverse_depth = sum / count});
  }
  return pixels;
}

/// In the order of the unknowns.
Optics known_sigma(const SolvedOptics& known) {
  const SensorOptics& sigma = known.sigma;
  return {sigma.fx / known.value.fx, sigma.cx, sigma.cy, sigma.k1};
}

/// The camera and the axis that are solved, and how they move.
class OpticsState {
 public:
  /// @param pattern  as of `solve_optics`: it moves the principal point by up to 12 pixels
  OpticsState(const CalibrationTurn& turn, const Isometry3d& start, double pattern)
      : camera{.pinhole = turn.intrinsics},
        pose(start),
        spread(unit_spread),
        sensor_(turn.intrinsics) {
    if (turn.optics) {
      spread = (known_sigma(*turn.optics).array().square() + turn_spread.array().square()).sqrt();
    }
    if (pattern > 0) {
      spread.tail<optics_count - 1>().setConstant(held_sigma);
    }
  }

  /// Derivatives of a point of the platform's frame by the optics.
  OpticsMotion motion(const Vector3d& point_in_platform) const {
    const Vector3d point = pose.inverse() * point_in_platform;
    const Vector3d across(point.x(), point.y(), 0);
    OpticsMotion moved;
    moved.col(0) = -across;
    moved.col(1) = Vector3d(-point.z() / camera.pinhole.fx, 0, 0);
    moved.col(2) = Vector3d(0, -point.z() / camera.pinhole.fy, 0);
    moved.col(3) = -across.squaredNorm() / (point.z() * point.z()) * across;
    return pose.linear() * moved;
  }

  void move(const UnknownVector& step) {
    optics += step.tail<optics_count>();
    camera.pinhole.fx = sensor_.fx * (1 + optics[0]);
    camera.pinhole.fy = sensor_.fy * (1 + optics[0]);
    camera.pinhole.cx = sensor_.cx + optics[1];
    camera.pinhole.cy = sensor_.cy + optics[2];
    camera.distortion.k1 = optics[3];
    const Vector3d rotation(step[0], step[1], 0);
    Isometry3d change = Isometry3d::Identity();
    if (const double angle = rotation.norm(); angle > 0) {
      change.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
    }
    change.translation() = Vector3d(step[2], step[3], step[height_at]);
    pose = change * pose;
    tilt += step.segment<2>(tilt_at);
  }

  DistortedCamera camera;
  Isometry3d pose;
  Vector2d tilt = Vector2d::Zero();  // of the platform against the axis: dz/dx and dz/dy
  Optics optics = Optics::Zero();    // their change, in the order of the optics_unknowns
  Optics spread;                     // sigmas of the optics before the turn

 private:
  Intrinsics sensor_;
};

void read_again(TurnViews& turn, const OpticsState& state) {
  ObjectView::Mask mask = make_mask(state.pose);
  mask.min_height = reading_height;
  for (std::size_t stop = 0; stop < turn.views.size(); ++stop) {
    turn.views[stop].set_camera(state.camera, mask);
    turn.readings[stop] = turn.views[stop].readings(turn.spacing);
  }
}

/// The residuals of the platform's flatness, in units of their sigma.
NormalEquations<optics_unknowns> platform_equations(const OpticsState& state,
                                                    const std::vector<PlatformPixel>& pixels) {
  NormalEquations<optics_unknowns> all;
  double squares = 0;
  for (const PlatformPixel& pixel : pixels) {
    const Vector3d seen = state.camera.ray(pixel.u, pixel.v) / pixel.inverse_depth;
    const Vector3d point = state.pose * seen;
    // A unit of disparity moves a reading along its ray; what counts is how far that is upward.
    const double unit =
        std::abs((state.pose.linear() * seen).z()) * disparity_unit / pixel.inverse_depth;
    const double residual = (point.z() - state.tilt.dot(point.head<2>())) / unit;
    UnknownVector row = UnknownVector::Zero();
    row[0] = point.y();
    row[1] = -point.x();
    row[height_at] = 1;
    row.segment<2>(tilt_at) = -point.head<2>();
    row.tail<optics_count>() = state.motion(point).row(2).transpose();
    if (std::abs(residual) < max_platform_residual) {
      all.add(row / unit, residual, 1);
      squares += residual * residual;
    }
  }
  const double uneven = std::sqrt(squares / std::max<double>(static_cast<double>(all.count), 1));
  const double sigma = std::max(uneven, min_unevenness);
  return all.scaled(sigma * sigma * correlated_samples);
}

/// The residuals between stops. `correlation` and systematic errors are not in their weights.
NormalEquations<optics_unknowns> object_equations(const TurnViews& views, const OpticsState& state,
                                                  const ResidualLimits& limits, int threads) {
  return normal_equations<optics_unknowns>(
      views, state.pose, limits, threads, [&](const StopResidual& residual) {
        UnknownVector row = UnknownVector::Zero();
        row.head<4>() = axis_row(residual);
        row.tail<optics_count>() =
            (residual.normal_from.transpose() * state.motion(residual.point_from) -
             residual.normal_to.transpose() * state.motion(residual.point_to))
                .transpose();
        return row;
      });
}

void add_priors(NormalEquations<optics_unknowns>& all, const OpticsState& state) {
  const double square = std::pow(radians_from_degrees(square_sigma_deg), -2);
  for (int axis = 0; axis < 2; ++axis) {
    all.matrix(tilt_at + axis, tilt_at + axis) += square;
    all.right[tilt_at + axis] -= square * state.tilt[axis];
  }
  for (int i = 0; i < optics_count; ++i) {
    const double information = 1 / (state.spread[i] * state.spread[i]);
    all.matrix(optics_at + i, optics_at + i) += information;
    all.right[optics_at + i] -= information * state.optics[i];
  }
}

/// @param turn  whose known optics, if any, were taken out of the depth images
SolvedOptics to_optics(const OpticsState& state, const CalibrationTurn& turn, const Optics& sigma) {
  const Intrinsics& lens = state.camera.pinhole;
  SolvedOptics solved =
      turn.optics.value_or(SolvedOptics{.value = {},
                                        .sigma = {.k2 = k2_sigma,
                                                  .depth_scale = unknown_scale_sigma,
                                                  .depth_offset_per_m = depth_offset_sigma}});
  solved.value.fx = lens.fx;
  solved.value.fy = lens.fy;
  solved.value.cx = lens.cx;
  solved.value.cy = lens.cy;
  solved.value.k1 += state.camera.distortion.k1;  // the rest: to first order they add up
  solved.sigma.fx = sigma[0] * turn.intrinsics.fx;
  solved.sigma.fy = sigma[0] * turn.intrinsics.fy;
  solved.sigma.cx = sigma[1];
  solved.sigma.cy = sigma[2];
  solved.sigma.k1 = sigma[3];
  return solved;
}

}  // namespace

CalibrationFinding describe_unused_optics(const SensorOptics& solved, const Intrinsics& used) {
  const double centre = std::hypot(solved.cx - used.cx, solved.cy - used.cy) / used.fx;
  const double share = std::abs(solved.fx / used.fx - 1) + shear_of_centre * centre;
  std::array<char, 192> text{};
  std::snprintf(text.data(), text.size(),
                "the sensor's optics are not as known, and the turn that measured them was "
                "refused: sizes may be wrong by %.1f %%",
                100 * share);
  return {.code = "optics",
          .detail = text.data(),
          .hint = "Stand another object on the platform, and calibrate the rig.",
          .stop = {},
          .angle = {},
          .parameters = {{"size_share", share}}};
}

CalibrationFinding describe_focal_length(double seen, double configured) {
  const double error = std::abs(seen / configured - 1);
  std::array<char, 128> text{};
  std::snprintf(
      text.data(), text.size(),
      "the sensor's focal length is %.1f %% %s than configured: %.0f pixels instead of %.0f",
      100 * error, seen > configured ? "longer" : "shorter", seen, configured);
  return {.code = "focal-length",
          .detail = text.data(),
          .hint =
              "Look whether the scan is of this sensor, and its depth images "
              "of their full size.",
          .stop = {},
          .angle = {},
          .parameters = {{seen > configured ? "longer_share" : "shorter_share", error},
                         {"seen_px", seen},
                         {"told_px", configured}}};
}

std::optional<OpticsSolution> solve_optics(TurnViews& views, const PlatformSamples& samples,
                                           const PlatformPlane& plane, const CalibrationTurn& turn,
                                           const Isometry3d& start, double pattern, int threads) {
  const std::vector<PlatformPixel> pixels = platform_pixels(samples, plane);
  OpticsState state(turn, start, pattern);
  UnknownMatrix covariance = UnknownMatrix::Identity();
  UnknownMatrix matrix = UnknownMatrix::Identity();  // its inverse
  UnknownVector step = UnknownVector::Zero();
  for (int i = 0; i < max_optics_steps; ++i) {
    const auto sums = object_equations(views, state, i == 0 ? first_limits : later_limits, threads);
    if (sums.count < min_residuals) {
      return std::nullopt;
    }
    const double variance = sums.squares / sums.weight * views.correlation;
    auto all = sums.scaled(variance + systematic * systematic * sums.weight);
    const auto platform = platform_equations(state, pixels);
    all.matrix += platform.matrix;
    all.right += platform.right;
    add_priors(all, state);
    const auto solution = solve_symmetric(all.matrix, all.right);
    if (!solution || std::abs(solution->values[optics_at]) > max_focal_change) {
      return std::nullopt;
    }
    step = solution->values;
    matrix = all.matrix;
    covariance = solution->inverse;
    state.move(step);
    read_again(views, state);
    if (step.segment<2>(2).norm() < settled_optics) {
      break;
    }
  }
  if (pattern > 0) {
    covariance(optics_at, optics_at) +=
        std::pow(focal_sigma_of_pattern * std::max(pattern, usual_pattern), 2);
  }
  Optics sigma = covariance.diagonal().tail<optics_count>().cwiseSqrt();
  // With the optics known, the axis is determined better than among all unknowns.
  const auto axis = solve_symmetric(matrix.topLeftCorner<4, 4>(), Eigen::Vector4d::Zero());
  const auto change =
      solve_symmetric(covariance.bottomRightCorner<optics_count, optics_count>(), state.optics);
  if (!axis || !change) {
    return std::nullopt;
  }
  const bool is_better =
      turn.optics &&
      (sigma.head<3>().array() < better_sigma * known_sigma(*turn.optics).head<3>().array()).any();
  if (pattern > 0) {
    sigma.tail<optics_count - 1>() = unit_spread.tail<optics_count - 1>();
  }
  return OpticsSolution{.optics = to_optics(state, turn, sigma),
                        .axis = {.platform_from_sensor = state.pose,
                                 .covariance = axis->inverse,
                                 .last_step = step.segment<2>(2).norm()},
                        .significance = state.optics.dot(change->values),
                        .is_better = is_better};
}

}  // namespace octurn
