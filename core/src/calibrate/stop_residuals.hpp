#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <vector>

#include "calibrate/object_view.hpp"
#include "solve/symmetric_solver.hpp"

namespace octurn {

/// Two stops whose views of the object are compared: readings of `from` with the surface of `to`.
struct StopPair {
  std::size_t from = 0;
  std::size_t to = 0;
};

/// Stops up to this far apart are compared where no others are at the preferred angles.
inline constexpr double max_neighbour_deg = 100;

/// Both directions of the pairs of stops that are about 15, 30, 45 or 75 degrees apart, with few
/// stops also 90; if there are none, neighbours less than 100 degrees apart. Sorted by `from`.
/// @param angles  of the stops, radians
std::vector<StopPair> make_stop_pairs(const std::vector<double>& angles);

/// The object's readings at all stops.
struct TurnViews {
  std::vector<double> angles = {};  ///< of the stops, radians
  std::vector<ObjectView> views = {};
  std::vector<std::vector<SurfaceReading>> readings = {};
  int spacing = 1;  ///< pixels between readings
  std::vector<StopPair> pairs = {};
  /// Residuals per independent one: the sensor's errors are correlated in neighbouring pixels, and
  /// a reading is compared with several stops.
  double correlation = 1;
};

/// Distance of a reading of one stop from the surface that another stop saw.
struct StopResidual {
  std::size_t from = 0;
  std::size_t to = 0;
  double distance = 0;                                    ///< metres, along the surface's normal
  Eigen::Vector3d point_from = Eigen::Vector3d::Zero();   ///< platform frame at `from`
  Eigen::Vector3d normal_from = Eigen::Vector3d::Zero();  ///< the surface's, in the same frame
  Eigen::Vector3d point_to = Eigen::Vector3d::Zero();  ///< of the surface, platform frame at `to`
  Eigen::Vector3d normal_to = Eigen::Vector3d::Zero();
};

/// Limits of the comparison, and the weights of residuals.
struct ResidualLimits {
  double max_distance = 0.02;   ///< metres: beyond it lies another surface
  double cauchy_scale = 0.004;  ///< metres

  double weight(double distance) const { return cauchy_weight(distance, cauchy_scale); }
};

/// With fewer residuals of a turn nothing is solved.
inline constexpr std::size_t min_residuals = 60;

/// Compares the readings of one stop with the surfaces that its partners saw.
/// @param platform_from_sensor  that is tried, metres
/// @param stop_offsets          radians, of each stop: true angle less the configured one
/// @param visit                 called with each StopResidual
template <typename Visit>
void for_each_residual(const TurnViews& turn, const Eigen::Isometry3d& platform_from_sensor,
                       const std::vector<double>& stop_offsets, std::size_t from,
                       const ResidualLimits& limits, Visit visit) {
  const Eigen::Isometry3d sensor_from_platform = platform_from_sensor.inverse();
  std::vector<SurfaceReading> placed = turn.readings[from];  // in the platform's frame
  for (SurfaceReading& reading : placed) {
    reading = {.point = platform_from_sensor * reading.point,
               .normal = platform_from_sensor.linear() * reading.normal};
  }
  for (const StopPair& pair : turn.pairs) {
    if (pair.from != from) {
      continue;
    }
    const double angle =
        turn.angles[pair.to] + stop_offsets[pair.to] - turn.angles[from] - stop_offsets[from];
    const Eigen::Matrix3d to_from_from =
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const ObjectView& view = turn.views[pair.to];
    for (const SurfaceReading& reading : placed) {
      const Eigen::Vector3d turned = to_from_from * reading.point;
      const auto surface = view.look_up(sensor_from_platform * turned);
      if (!surface) {
        continue;
      }
      const Eigen::Vector3d normal = platform_from_sensor.linear() * surface->normal;
      const Eigen::Vector3d back = to_from_from.transpose() * normal;
      const Eigen::Vector3d seen = platform_from_sensor * surface->point;
      const double distance = normal.dot(turned - seen);
      if (std::abs(distance) < limits.max_distance &&
          back.dot(reading.normal) > min_normal_agreement) {
        visit(StopResidual{.from = from,
                           .to = pair.to,
                           .distance = distance,
                           .point_from = reading.point,
                           .normal_from = back,
                           .point_to = seen,
                           .normal_to = normal});
      }
    }
  }
}

/// The median magnitude of the residuals below 20 mm, metres; 0 if there are none.
double median_residual(const TurnViews& turn, const Eigen::Isometry3d& platform_from_sensor,
                       const std::vector<double>& stop_offsets, int threads);

}  // namespace octurn
