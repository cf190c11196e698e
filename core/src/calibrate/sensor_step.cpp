#include "calibrate/sensor_step.hpp"

#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdio>

#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double tilt_lever = 0.1;  // metres: a tilt counts by its height there
constexpr double min_size = 5e-4;   // metres
constexpr double bump_sigmas = 5;
constexpr double min_bump_explained =
    0.85;  // above the 0.75 that a step explains of a steady drift

/// Measurements of each stop: a tilt's two components times the lever, and a height.
constexpr Index rows_of_stop = 3;
constexpr Index background_columns = 5;  // a mean, and a tilt that turns with the platform

struct Fit {
  VectorXd values;
  double squares = 0;
  MatrixXd inverse;  // of the normal matrix
};

Fit fit(const MatrixXd& columns, const VectorXd& measured) {
  Fit solved{.values = {}, .inverse = (columns.transpose() * columns).inverse()};
  solved.values = solved.inverse * (columns.transpose() * measured);
  solved.squares = (measured - columns * solved.values).squaredNorm();
  return solved;
}

MatrixXd make_background(const std::vector<double>& angles) {
  MatrixXd columns =
      MatrixXd::Zero(rows_of_stop * static_cast<Index>(angles.size()), background_columns);
  for (std::size_t stop = 0; stop < angles.size(); ++stop) {
    const Index row = rows_of_stop * static_cast<Index>(stop);
    columns.block<3, 3>(row, 0).setIdentity();
    columns.block<2, 2>(row, 3) = Eigen::Rotation2Dd(angles[stop]).toRotationMatrix();
  }
  return columns;
}

}  // namespace

std::optional<SensorStep> solve_sensor_step(const std::vector<StopPlane>& planes,
                                            const std::vector<double>& angles) {
  if (planes.empty()) {
    return std::nullopt;
  }
  const MatrixXd background = make_background(angles);
  VectorXd measured(background.rows());
  for (std::size_t stop = 0; stop < planes.size(); ++stop) {
    measured.segment<rows_of_stop>(rows_of_stop * static_cast<Index>(stop))
        << tilt_lever * planes[stop].tilt,
        planes[stop].height;
  }
  const double all_squares = fit(background, measured).squares;
  SensorStep best;
  for (std::size_t stop = 1; stop < planes.size(); ++stop) {
    MatrixXd columns = MatrixXd::Zero(background.rows(), rows_of_stop + background_columns);
    columns.rightCols<background_columns>() = background;
    for (Index row = rows_of_stop * static_cast<Index>(stop); row < columns.rows();
         row += rows_of_stop) {
      columns.block<rows_of_stop, rows_of_stop>(row, 0).setIdentity();
    }
    const Fit solved = fit(columns, measured);
    const double explained = 1 - solved.squares / all_squares;
    if (explained > best.explained) {
      const Eigen::Vector3d step = solved.values.head<rows_of_stop>();
      const double variance = solved.squares / static_cast<double>(columns.rows() - columns.cols());
      best = {
          .stop = stop,
          .tilt = step.head<2>().norm() / tilt_lever,
          .height = step.z(),
          .size = step.norm(),
          .sigma = std::sqrt(variance * solved.inverse.diagonal().head<rows_of_stop>().maxCoeff()),
          .explained = explained};
    }
  }
  return best;
}

std::optional<CalibrationFinding> find_bump(const SensorStep& step) {
  if (step.size < min_size || step.size < bump_sigmas * step.sigma ||
      step.explained < min_bump_explained) {
    return std::nullopt;
  }
  std::array<char, 128> text{};
  std::snprintf(
      text.data(), text.size(),
      "between stops %zu and %zu the sensor moved: the platform tilts by %.1f degrees and "
      "%s by %.1f mm as it sees it",
      step.stop - 1, step.stop, degrees_from_radians(step.tilt),
      step.height > 0 ? "rises" : "sinks", mm_from_metres(std::abs(step.height)));
  return CalibrationFinding{.code = "moved",
                            .detail = text.data(),
                            .hint = "Fix the sensor and the platform, calibrate, and scan again.",
                            .stop = {},
                            .angle = {},
                            .parameters = {{"from_stop", static_cast<double>(step.stop - 1)},
                                           {"to_stop", static_cast<double>(step.stop)},
                                           {"tilt_deg", degrees_from_radians(step.tilt)},
                                           {step.height > 0 ? "rise_mm" : "sink_mm",
                                            mm_from_metres(std::abs(step.height))}}};
}

}  // namespace octurn
