#include "calibrate/focal_length.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "calibrate/axis_solver.hpp"
#include "calibrate/normal_equations.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

constexpr std::array focal_schedule = {
    ResidualLimits{.max_distance = 0.01, .cauchy_scale = 0.003},
    ResidualLimits{.max_distance = 0.005, .cauchy_scale = 0.002},
    ResidualLimits{.max_distance = 0.005, .cauchy_scale = 0.002}};
constexpr double direction_sigma_deg = 0.05;  // between the plane's normal and the axis
// Metres: systematic error of the residuals at edges and grazing angles, all around an object. A
// focal length 1 % off changes those of a flat box by as much.
constexpr double systematic_error = 3e-5;
constexpr double max_change = 0.2;  // in one iteration: more is no focal length
constexpr double min_error = 0.01;
constexpr double focal_sigmas = 5;

/// Derivative of points in the platform frame by the focal factor s, with the plane kept at z = 0.
class Widening {
 public:
  Widening(const PlatformPlane& plane, const Isometry3d& platform_from_sensor)
      : pose_(platform_from_sensor), back_(platform_from_sensor.inverse()) {
    const Vector3d& normal = plane.normal;
    const Vector3d across(-normal.x(), -normal.y(), 0);
    const Vector3d tilt = pose_.linear() * (across - normal * normal.dot(across));
    turning_ = Vector3d(tilt.y(), -tilt.x(), 0);
    rise_ = -(pose_.linear() * flattened(back_.translation())).z();
  }

  /// Metres for each unit of the factor. @param point  of the platform's frame
  Vector3d operator()(const Vector3d& point) const {
    return pose_.linear() * flattened(back_ * point) + turning_.cross(point) +
           rise_ * Vector3d::UnitZ();
  }

  /// Radians about x and y for each unit of the factor.
  Eigen::Vector2d turning() const { return turning_.head<2>(); }

 private:
  static Vector3d flattened(const Vector3d& seen) { return {seen.x(), seen.y(), 0}; }

  Isometry3d pose_;
  Isometry3d back_;
  Vector3d turning_;
  double rise_ = 0;
};

/// The normal of a surface stretched by the factor. Not of length one.
Vector3d widened_normal(const Vector3d& normal, double factor) {
  return {normal.x() / factor, normal.y() / factor, normal.z()};
}

void widen(TurnViews& turn, double factor) {
  for (ObjectView& view : turn.views) {
    view.widen(factor);
  }
  for (std::vector<SurfaceReading>& readings : turn.readings) {
    for (SurfaceReading& reading : readings) {
      reading.point.head<2>() *= factor;
      reading.normal = widened_normal(reading.normal, factor).normalized();
    }
  }
}

PlatformPlane widened(PlatformPlane plane, double factor) {
  const Vector3d normal = widened_normal(plane.normal, factor);
  plane.offset /= normal.norm();
  plane.normal = normal.normalized();
  return plane;
}

}  // namespace

std::optional<FocalLength> solve_focal_length(TurnViews& turn, PlatformPlane plane,
                                              Isometry3d platform_from_sensor, int threads) {
  const double information = std::pow(radians_from_degrees(direction_sigma_deg), -2);
  double width = 1;
  double sigma = 0;
  for (const ResidualLimits& limits : focal_schedule) {
    const Widening widening(plane, platform_from_sensor);
    const NormalEquations sums = normal_equations<5>(
        turn, platform_from_sensor, limits, threads, [&](const StopResidual& residual) {
          Vector5d row;
          row << axis_row(residual), residual.normal_from.dot(widening(residual.point_from)) -
                                         residual.normal_to.dot(widening(residual.point_to));
          return row;
        });
    if (sums.count < min_residuals) {
      return std::nullopt;
    }
    const double variance = sums.squares / sums.weight * turn.correlation;
    NormalEquations scaled = sums.scaled(variance);
    scaled.add_plane(platform_from_sensor.linear() * plane.normal, information);
    const Eigen::LDLT<Matrix5d> factors(scaled.matrix);
    const Vector5d motion = factors.solve(scaled.right);
    if (!motion.allFinite() || std::abs(motion[4]) > max_change) {
      return std::nullopt;
    }
    const double factor = 1 + motion[4];
    widen(turn, factor);
    plane = widened(plane, factor);
    Eigen::Vector4d of_axis = motion.head<4>();
    of_axis.head<2>() += motion[4] * widening.turning();
    platform_from_sensor = with_axis_moved(platform_from_sensor, plane, of_axis);
    width *= factor;
    const double noise = std::sqrt(factors.solve(Vector5d::Unit(4))[4]);
    const double sensitivity = std::sqrt(variance / sums.weight) / noise;
    sigma = std::hypot(noise, systematic_error / sensitivity);
  }
  return FocalLength{.ratio = 1 / width, .sigma = sigma};
}

std::optional<CalibrationFinding> find_wrong_focal_length(const FocalLength& solved, double told) {
  const double error = std::abs(solved.ratio - 1);
  if (error < min_error || error < focal_sigmas * solved.sigma) {
    return std::nullopt;
  }
  std::array<char, 128> text{};
  std::snprintf(
      text.data(), text.size(),
      "the sensor's focal length is %.1f %% %s than configured: %.0f pixels instead of %.0f",
      100 * error, solved.ratio > 1 ? "longer" : "shorter", told * solved.ratio, told);
  return CalibrationFinding{
      .code = "focal-length",
      .detail = text.data(),
      .hint =
          "Look whether the scan is of this sensor, and its depth images "
          "of their full size.",
      .stop = {},
      .angle = {},
      .parameters = {{solved.ratio > 1 ? "longer_share" : "shorter_share", error},
                     {"seen_px", told * solved.ratio},
                     {"told_px", told}}};
}

}  // namespace octurn
