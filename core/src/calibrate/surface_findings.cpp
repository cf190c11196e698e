#include "calibrate/surface_findings.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "io/number_text.hpp"
#include "octurn/sensor_map.hpp"
#include "octurn/units.hpp"

namespace octurn {

using Eigen::Vector2d;

namespace {

using Eigen::Vector3d;

constexpr std::size_t min_stops = 6;
constexpr std::size_t min_pixels = 500;

/// The pixels that see the platform at every stop. All stops use the same pixels, so that a pixel's
/// fixed error is the same at each.
std::vector<std::size_t> always_seen(const PlatformSamples& samples,
                                     const std::vector<bool>& is_plane) {
  std::vector<std::size_t> pixels;
  for (std::size_t pixel = 0; pixel < samples.rays.size(); ++pixel) {
    bool is_seen = is_plane[pixel];
    for (const std::vector<float>& depths : samples.depths) {
      is_seen = is_seen && depths[pixel] > 0;
    }
    if (is_seen) {
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

double inverse(float depth) { return 1 / static_cast<double>(depth); }

/// The mean over all stops of each pixel's inverse depth, 1/m.
std::vector<double> mean_inverse_depths(const PlatformSamples& samples,
                                        const std::vector<std::size_t>& pixels) {
  std::vector<double> means;
  means.reserve(pixels.size());
  for (const std::size_t pixel : pixels) {
    double sum = 0;
    for (const std::vector<float>& depths : samples.depths) {
      sum += inverse(depths[pixel]);
    }
    means.push_back(sum / static_cast<double>(samples.depths.size()));
  }
  return means;
}

}  // namespace

std::vector<StopPlane> measure_stop_planes(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane,
                                           const Eigen::Isometry3d& levelled) {
  const std::vector<std::size_t> pixels = always_seen(samples, is_plane);
  if (samples.depths.size() < min_stops || pixels.size() < min_pixels) {
    return {};
  }
  const std::vector<double> means = mean_inverse_depths(samples, pixels);
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  for (const std::size_t pixel : pixels) {
    square += samples.rays[pixel] * samples.rays[pixel].transpose();
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(square);

  const Vector3d middle = levelled.inverse().translation();
  std::vector<StopPlane> planes;
  planes.reserve(samples.depths.size());
  for (const std::vector<float>& depths : samples.depths) {
    Vector3d right = Vector3d::Zero();
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      right += samples.rays[pixels[i]] * (inverse(depths[pixels[i]]) - means[i]);
    }
    // A plane is 1/z = (normal / offset) . ray.
    const Vector3d seen = plane.normal / plane.offset + solver.solve(right);
    const Vector3d normal = std::copysign(1.0, plane.offset) * seen.normalized();
    planes.push_back({.tilt = (levelled.linear() * normal).head<2>(),
                      .height = std::copysign(1 / seen.norm(), plane.offset) - normal.dot(middle)});
  }
  return planes;
}

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

namespace {

constexpr double bad_wobble_sigmas = 5;
constexpr double min_wobble_deg = 0.3;
constexpr int wobble_digits = 2;  // of degrees

/// Adds the finding "wobble" if the platform tilts as it turns.
void add_wobble(CalibrationReport& report, const std::optional<PlatformWobble>& wobble) {
  if (wobble && wobble->angle > std::max(radians_from_degrees(min_wobble_deg),
                                         bad_wobble_sigmas * wobble->sigma)) {
    report.findings.push_back(
        {.code = "wobble",
         .detail = "the platform's surface tilts by " + degrees_text(wobble->angle, wobble_digits) +
                   " as it turns",
         .hint = "Look whether the platform sits straight on the motor.",
         .parameters = {{"wobble_deg", degrees_from_radians(wobble->angle)}}});
  }
}

}  // namespace

SurfaceFindings look_at_surface(CalibrationReport& report, const PlatformSamples& samples,
                                const PlatformPlane& plane, const std::vector<double>& angles,
                                const Eigen::Isometry3d& levelled) {
  const std::vector<bool> is_plane = find_plane_pixels(samples, plane);
  const std::vector<StopPlane> planes = measure_stop_planes(samples, plane, is_plane, levelled);
  SurfaceFindings surface{.unevenness = measure_platform_map(samples, plane, is_plane)};
  const auto step = solve_sensor_step(planes, angles);
  if (auto bump = step ? find_bump(*step) : std::nullopt) {
    report.findings = {*std::move(bump)};  // which looks like a slip, or a move of the object
    surface.bump = step;
  }
  add_wobble(report, measure_wobble(planes, angles));
  return surface;
}

void add_no_map(CalibrationReport& report, double unevenness) {
  report.findings.push_back(
      {.code = "no-map",
       .detail = "the flat platform looks uneven by " +
                 number_text("%.2f units of the sensor's disparity", unevenness),
       .hint =
           "Make the sensor's map from a bare wall: models become up to four times more accurate.",
       .parameters = {{"unevenness_disparity", unevenness}}});
}

namespace {

constexpr std::size_t block_samples = 8;  // to a side of a block, of 4 pixels each
constexpr std::size_t min_samples = block_samples * block_samples / 2;  // in a block
constexpr std::size_t min_blocks = 6;

/// For each sample on the plane its mean distance from it over all stops, units of disparity.
double mean_difference(const PlatformSamples& samples, const PlatformPlane& plane,
                       std::size_t sample) {
  const double expected = plane.normal.dot(samples.rays[sample]) / plane.offset;
  double sum = 0;
  std::size_t count = 0;
  for (const std::vector<float>& depths : samples.depths) {
    const auto z = static_cast<double>(depths[sample]);
    if (z > 0) {
      sum += 1 / z - expected;
      ++count;
    }
  }
  return sum / (disparity_unit * static_cast<double>(count));
}

}  // namespace

std::optional<double> measure_platform_map(const PlatformSamples& samples,
                                           const PlatformPlane& plane,
                                           const std::vector<bool>& is_plane) {
  struct Sum {
    double differences = 0;
    std::size_t count = 0;
  };
  const std::size_t blocks_in_row = samples.columns / block_samples + 1;
  std::vector<Sum> sums((samples.rays.size() / samples.columns / block_samples + 1) *
                        blocks_in_row);
  for (std::size_t sample = 0; sample < samples.rays.size(); ++sample) {
    if (is_plane[sample]) {
      Sum& sum = sums[sample / samples.columns / block_samples * blocks_in_row +
                      sample % samples.columns / block_samples];
      sum.differences += mean_difference(samples, plane, sample);
      ++sum.count;
    }
  }
  double squares = 0;
  std::size_t blocks = 0;
  for (const Sum& sum : sums) {
    if (sum.count >= min_samples) {
      const double mean = sum.differences / static_cast<double>(sum.count);
      squares += mean * mean;
      ++blocks;
    }
  }
  return blocks >= min_blocks ? std::optional(std::sqrt(squares / static_cast<double>(blocks)))
                              : std::nullopt;
}

std::optional<PlatformWobble> measure_wobble(const std::vector<StopPlane>& planes,
                                             const std::vector<double>& angles) {
  if (planes.empty()) {
    return std::nullopt;
  }
  std::vector<Vector2d> tilts;  // in the frame that turns with the platform
  tilts.reserve(planes.size());
  Vector2d mean = Vector2d::Zero();
  for (std::size_t stop = 0; stop < planes.size(); ++stop) {
    tilts.emplace_back(Eigen::Rotation2Dd(-angles[stop]) * planes[stop].tilt);
    mean += tilts.back();
  }
  const auto stops = static_cast<double>(planes.size());
  mean /= stops;
  double squares = 0;
  for (const Vector2d& tilt : tilts) {
    squares += (tilt - mean).squaredNorm();
  }
  return PlatformWobble{.angle = mean.norm(),
                        .sigma = std::sqrt(squares / (2 * (stops - 1)) / stops)};
}

}  // namespace octurn
