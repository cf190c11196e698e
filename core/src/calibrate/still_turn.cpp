#include "calibrate/still_turn.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "calibrate/object_view.hpp"
#include "calibrate/platform_samples.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// The volume of objects on the platform, metres: above its noise, and in front of walls behind it.
constexpr double max_object_radius = 0.17;
constexpr double min_object_height = 0.006;
constexpr double disparity_noise = 4 * disparity_unit;
// Readings at an object's edges jump between object and background.
constexpr double edge_share = 0.1;

/// A reading in the platform's frame, metres, if something on the platform was read.
std::optional<Vector3d> object_point(const PlatformSamples& samples,
                                     const std::vector<float>& depths, std::size_t pixel,
                                     const Isometry3d& platform_from_sensor) {
  if (!(depths[pixel] > 0)) {
    return std::nullopt;
  }
  const Vector3d point =
      platform_from_sensor * (samples.rays[pixel] * static_cast<double>(depths[pixel]));
  const bool is_object = point.z() > min_object_height && point.z() < max_object_height &&
                         point.head<2>().squaredNorm() < max_object_radius * max_object_radius;
  return is_object ? std::optional(point) : std::nullopt;
}

/// The number of compared readings, and of those that disagree.
struct Count {
  std::size_t all = 0;
  std::size_t wrong = 0;

  bool is_edges_alone() const {
    return static_cast<double>(wrong) <= edge_share * static_cast<double>(all);
  }
};

/// Compares what two stops read of an object.
Count count_differences(const PlatformSamples& samples, const std::vector<float>& first,
                        const std::vector<float>& other, const Isometry3d& platform_from_sensor) {
  Count count;
  for (std::size_t pixel = 0; pixel < samples.rays.size(); ++pixel) {
    const bool is_read_twice = first[pixel] > 0 && other[pixel] > 0;
    if (is_read_twice && (object_point(samples, first, pixel, platform_from_sensor) ||
                          object_point(samples, other, pixel, platform_from_sensor))) {
      const double difference =
          1 / static_cast<double>(first[pixel]) - 1 / static_cast<double>(other[pixel]);
      ++count.all;
      count.wrong += std::abs(difference) > disparity_noise ? 1 : 0;
    }
  }
  return count;
}

/// Rotates the first stop's readings of an object, and counts those that lie in its free space.
Count compare_turned(const PlatformSamples& samples, const Intrinsics& lens,
                     const Isometry3d& platform_from_sensor, double angle) {
  const std::vector<float>& depths = samples.depths.front();
  const Isometry3d sensor_from_turned =
      platform_from_sensor.inverse() * Eigen::AngleAxisd(angle, Vector3d::UnitZ());
  Count count;
  for (std::size_t pixel = 0; pixel < samples.rays.size(); ++pixel) {
    const auto point = object_point(samples, depths, pixel, platform_from_sensor);
    if (!point) {
      continue;
    }
    const Vector3d turned = sensor_from_turned * *point;
    const auto at = sample_at(samples, lens, turned);
    if (at && depths[*at] > 0) {
      ++count.all;
      count.wrong +=
          1 / turned.z() - 1 / static_cast<double>(depths[*at]) > disparity_noise ? 1 : 0;
    }
  }
  return count;
}

bool looks_still(const PlatformSamples& samples, const Isometry3d& platform_from_sensor) {
  return std::ranges::all_of(samples.depths, [&](const std::vector<float>& depths) {
    return count_differences(samples, samples.depths.front(), depths, platform_from_sensor)
        .is_edges_alone();
  });
}

bool looks_round(const PlatformSamples& samples, const CalibrationTurn& turn,
                 const Isometry3d& platform_from_sensor) {
  return std::ranges::all_of(turn.angles, [&](double angle) {
    return compare_turned(samples, turn.intrinsics, platform_from_sensor, angle).is_edges_alone();
  });
}

}  // namespace

std::optional<StillTurn> find_still_turn(const PlatformSamples& samples,
                                         const CalibrationTurn& turn, const Isometry3d& levelled,
                                         const Isometry3d& solved, bool is_solved) {
  if (!looks_still(samples, levelled)) {
    return std::nullopt;
  }
  const bool is_round = looks_round(samples, turn, solved);
  if (is_round && is_solved) {
    return std::nullopt;
  }
  StillTurn still{
      .reason =
          "every stop shows the same: the platform did not turn, or the object looks the "
          "same from all sides. Look at the motor and its wiring, or stand another object "
          "on the platform"};
  if (!is_round) {
    const std::size_t stops = turn.angles.size();
    still.findings.push_back(
        {.code = "still",
         .detail = "each of " + std::to_string(stops) +
                   " stops shows what the first one shows: the platform did not turn",
         .hint = "Look at the motor, its power and its wiring.",
         .stop = {},
         .angle = {},
         .parameters = {{"stops", static_cast<double>(stops)}}});
  }
  return still;
}

}  // namespace octurn
