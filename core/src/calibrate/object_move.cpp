#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "calibrate/normal_equations.hpp"
#include "calibrate/object_view.hpp"
#include "calibrate/stop_step.hpp"
#include "io/number_text.hpp"
#include "io/sensor_json.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Readings = std::vector<SurfaceReading>;

constexpr double move_readings_wanted = 2000;
constexpr int max_move_spacing = 6;      // pixels
constexpr double min_found_again = 0.3;  // of the readings; fewer: another object, or none

// A prior for motions that the shape does not determine: a ball's turn, a wall's sideways shift.
constexpr double expected_noise = 0.001;  // metres
constexpr double min_noise = 0.0003;      // metres: residuals of so few readings may be less
constexpr double expected_shift = 0.003;
constexpr double expected_turn = 0.1;  // radians

constexpr double min_turn_deg = 0.6;
constexpr double certain_sigmas = 3;

constexpr std::array<ResidualLimits, 10> move_schedule{{{max_measured_shift, 0.004},
                                                        {max_measured_shift, 0.004},
                                                        {max_measured_shift, 0.004},
                                                        {max_measured_shift, 0.004},
                                                        {0.01, 0.002},
                                                        {0.01, 0.002},
                                                        {0.01, 0.002},
                                                        {0.005, 0.002},
                                                        {0.005, 0.002},
                                                        {0.005, 0.002}}};

/// A motion along the platform.
struct Motion {
  Vector3d middle = Vector3d::Zero();  ///< centre of the turn, platform's frame
  Vector2d shift = Vector2d::Zero();   ///< metres
  double turn = 0;                     ///< radians

  Vector3d operator()(const Vector3d& point) const {
    const Eigen::AngleAxisd rotation(turn, Vector3d::UnitZ());
    return rotation * (point - middle) + middle + Vector3d(shift.x(), shift.y(), 0);
  }
};

/// Readings inside the box, in the platform's frame.
Readings readings_in(const ObjectView& view, const Isometry3d& platform_from_sensor,
                     const Box& clip) {
  const int step = std::clamp(static_cast<int>(std::sqrt(view.pixels() / move_readings_wanted)), 1,
                              max_move_spacing);
  Readings inside;
  for (const SurfaceReading& reading : view.readings(step)) {
    const Vector3d point = platform_from_sensor * reading.point;
    if (contains(clip, point)) {
      inside.push_back({.point = point, .normal = platform_from_sensor.linear() * reading.normal});
    }
  }
  return inside;
}

/// The sigma of a shift in its own direction, so that length / sigma is the shift's Mahalanobis
/// distance from none. Directions that the shape does not determine do not enter.
double sigma_along(const Vector2d& shift, const Eigen::Matrix2d& covariance) {
  const double distance = std::sqrt(shift.dot(covariance.inverse() * shift));
  return distance > 0 ? shift.norm() / distance : std::sqrt(covariance.diagonal().maxCoeff());
}

Vector3d mean_point(const Readings& readings) {
  Vector3d sum = Vector3d::Zero();
  for (const SurfaceReading& reading : readings) {
    sum += reading.point;
  }
  return sum / static_cast<double>(std::max<std::size_t>(readings.size(), 1));
}

/// The least-squares problem for small changes of a motion: of shift x, shift y and turn.
NormalEquations<3> move_equations(const Readings& readings, const ObjectView& again,
                                  const Isometry3d& platform_from_sensor, const Motion& motion,
                                  const ResidualLimits& limits) {
  const Isometry3d sensor_from_platform = platform_from_sensor.inverse();
  const Eigen::AngleAxisd rotation(motion.turn, Vector3d::UnitZ());
  NormalEquations<3> all;
  for (const SurfaceReading& reading : readings) {
    const Vector3d point = motion(reading.point);
    const auto surface = again.look_up(sensor_from_platform * point);
    if (!surface) {
      continue;
    }
    const Vector3d normal = platform_from_sensor.linear() * surface->normal;
    const double distance = normal.dot(point - platform_from_sensor * surface->point);
    if (std::abs(distance) > limits.max_distance ||
        normal.dot(rotation * reading.normal) < min_normal_agreement) {
      continue;
    }
    const Vector3d turning =
        Vector3d::UnitZ().cross(Vector3d(rotation * (reading.point - motion.middle)));
    const Vector3d row(normal.x(), normal.y(), normal.dot(turning));
    all.add(row, distance, limits.weight(distance));
  }
  return all;
}

using nlohmann::json;

constexpr const char* last_look_key = "last_look";

/// Reads the scan.json of a folder, and checks that it is a scan's. @throws Error  as `read_scan`
json read_document(const std::filesystem::path& folder) {
  const std::string text =
      read_bytes(folder / "scan.json", ErrorCode::scan_missing,
                 "Name a folder that holds a whole scan.", ErrorCode::scan_malformed);
  parse_scan(text);
  return parse_json(text, ErrorCode::scan_malformed, "scan.json");
}

}  // namespace

std::optional<ObjectMove> measure_move(const Snapshot& first, const DepthFrame& again,
                                       const Box& clip) {
  const Isometry3d& pose = first.object_from_sensor;
  const ObjectView::Mask mask = make_mask(pose);
  const ObjectView before(first.frame, first.intrinsics, mask);
  const ObjectView after(again, first.intrinsics, mask);
  const Readings readings = readings_in(before, pose, clip);
  if (before.pixels() < min_object_pixels || readings.empty()) {
    return std::nullopt;
  }
  // Readings per independent one.
  const double correlation =
      std::max(1.0, correlated_pixels * static_cast<double>(readings.size()) / before.pixels());
  const double noise = correlation * expected_noise * expected_noise;
  const Vector3d prior(noise / (expected_shift * expected_shift),
                       noise / (expected_shift * expected_shift),
                       noise / (expected_turn * expected_turn));
  Motion motion{.middle = mean_point(readings)};
  ObjectMove move;
  for (const ResidualLimits& limits : move_schedule) {
    const NormalEquations<3> all = move_equations(readings, after, pose, motion, limits);
    if (static_cast<double>(all.count) < min_found_again * static_cast<double>(readings.size())) {
      return ObjectMove{.shift = max_measured_shift};
    }
    const Matrix3d normal_matrix = all.matrix + Matrix3d(prior.asDiagonal());
    const Vector3d state(motion.shift.x(), motion.shift.y(), motion.turn);
    const Eigen::LDLT<Matrix3d> factors(normal_matrix);
    const Vector3d change = factors.solve(all.right - prior.cwiseProduct(state));
    motion.shift += change.head<2>();
    motion.turn += change.z();
    const double variance = std::max(all.squares / all.weight, min_noise * min_noise) * correlation;
    const Matrix3d covariance = variance * factors.solve(Matrix3d::Identity());
    move = {.shift = motion.shift.norm(),
            .shift_sigma = sigma_along(motion.shift, covariance.topLeftCorner<2, 2>()),
            .turn = motion.turn,
            .turn_sigma = std::sqrt(covariance(2, 2))};
  }
  return move;
}

void add_move(std::vector<CalibrationFinding>& findings, const ObjectMove& move) {
  constexpr std::array<std::string_view, 3> explanations{"moved", "slip", "turn-not-whole"};
  const bool is_explained = std::ranges::any_of(findings, [&](const CalibrationFinding& finding) {
    return std::ranges::find(explanations, finding.code) != explanations.end();
  });
  const bool has_shifted = move.shift > std::max(min_move_shift, certain_sigmas * move.shift_sigma);
  const bool has_turned = std::abs(move.turn) > std::max(radians_from_degrees(min_turn_deg),
                                                         certain_sigmas * move.turn_sigma);
  if (is_explained || !(has_shifted || has_turned)) {
    return;
  }
  const bool is_far = move.shift >= max_measured_shift;
  std::string detail = "one more look at the first stop: the object ";
  Parameters parameters;
  if (has_shifted) {
    detail += std::string("moved by ") + (is_far ? "more than " : "") + mm_text(move.shift, 1);
    parameters.emplace(is_far ? "min_shift_mm" : "shift_mm", mm_from_metres(move.shift));
  }
  if (has_turned) {
    detail += std::string(has_shifted ? " and " : "") + "turned by " +
              degrees_text(std::abs(move.turn), 1);
    parameters.emplace("turn_deg", degrees_from_radians(std::abs(move.turn)));
  }
  findings.push_back({.code = "moved",
                      .detail = std::move(detail),
                      .hint = "Fix the object to the platform, or turn more slowly.",
                      .stop = {},
                      .angle = {},
                      .parameters = std::move(parameters)});
}

void write_object_move(const std::filesystem::path& folder, const ObjectMove& move) {
  json document = read_document(folder);
  document[last_look_key] = {{"moved_mm", mm_from_metres(move.shift)},
                             {"moved_sigma_mm", mm_from_metres(move.shift_sigma)},
                             {"turned_deg", degrees_from_radians(move.turn)},
                             {"turned_sigma_deg", degrees_from_radians(move.turn_sigma)}};
  write_file(folder / "scan.json", document.dump(1) + "\n");
}

std::optional<ObjectMove> read_object_move(const std::filesystem::path& folder) {
  const json document = read_document(folder);
  JsonObject root(document, ErrorCode::scan_malformed, "");
  const auto last_look = root.value(last_look_key);
  if (!last_look) {
    return std::nullopt;
  }
  JsonObject keys(*last_look);
  return ObjectMove{.shift = metres_from_mm(keys.at("moved_mm").number()),
                    .shift_sigma = metres_from_mm(keys.at("moved_sigma_mm").number()),
                    .turn = radians_from_degrees(keys.at("turned_deg").number()),
                    .turn_sigma = radians_from_degrees(keys.at("turned_sigma_deg").number())};
}

}  // namespace octurn
