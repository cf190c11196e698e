#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "calibrate/object_view.hpp"
#include "calibrate/stop_pairs.hpp"

namespace octurn {

/// What was seen where a reading was looked up last.
struct LookedUp {
  std::optional<std::size_t> pixel = {};  ///< of the rectangle; nothing: not looked up yet
  std::optional<SurfaceReading> surface = {};
};

/// The object's readings at all stops.
struct TurnViews {
  std::vector<double> angles = {};  ///< of the stops, radians
  std::vector<ObjectView> views = {};
  std::vector<std::vector<SurfaceReading>> readings = {};
  std::vector<StopPair> pairs = {};
  /// Residuals per independent one: the sensor's errors are correlated in neighbouring pixels, and
  /// a reading is compared with several stops.
  double correlation = 1;
  /// Of each pair, of each reading of its first stop: a solver that settles looks readings up at
  /// the same pixels again and again. Changed by the one thread that compares that stop. Empty:
  /// nothing is kept.
  mutable std::vector<std::vector<LookedUp>> looked_up = {};
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
  double max_distance = 0.02;   ///< metres: what is farther off is another surface
  double cauchy_scale = 0.004;  ///< metres

  double weight(double distance) const {
    const double ratio = distance / cauchy_scale;
    return 1 / (1 + ratio * ratio);
  }
};

/// Compares the readings of one stop with the surfaces that its partners saw.
/// @param platform_from_sensor  that is tried, metres
/// @param stop_offsets          radians that each stop turned further than told
/// @param visit                 called with each StopResidual
template <typename Visit>
void for_each_residual(const TurnViews& turn, const Eigen::Isometry3d& platform_from_sensor,
                       const std::vector<double>& stop_offsets, std::size_t from,
                       const ResidualLimits& limits, Visit visit) {
  constexpr double min_agreement = 0.7;  // cosine between the two normals
  const Eigen::Isometry3d sensor_from_platform = platform_from_sensor.inverse();
  std::vector<SurfaceReading> placed = turn.readings[from];  // in the platform's frame
  for (SurfaceReading& reading : placed) {
    reading = {.point = platform_from_sensor * reading.point,
               .normal = platform_from_sensor.linear() * reading.normal};
  }
  std::vector<LookedUp> none;
  for (std::size_t which = 0; which < turn.pairs.size(); ++which) {
    const StopPair& pair = turn.pairs[which];
    if (pair.from != from) {
      continue;
    }
    const double angle =
        turn.angles[pair.to] + stop_offsets[pair.to] - turn.angles[from] - stop_offsets[from];
    const Eigen::Matrix3d to_from_from =
        Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const ObjectView& view = turn.views[pair.to];
    std::vector<LookedUp>& looked_up = turn.looked_up.empty() ? none : turn.looked_up[which];
    looked_up.resize(placed.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const Eigen::Vector3d turned = to_from_from * placed[i].point;
      const auto pixel = view.find_pixel(sensor_from_platform * turned);
      if (!pixel) {
        continue;
      }
      if (looked_up[i].pixel != pixel || turn.looked_up.empty()) {
        looked_up[i] = {.pixel = pixel, .surface = view.read(*pixel)};
      }
      const auto& surface = looked_up[i].surface;
      if (!surface) {
        continue;
      }
      const Eigen::Vector3d normal = platform_from_sensor.linear() * surface->normal;
      const Eigen::Vector3d back = to_from_from.transpose() * normal;
      const Eigen::Vector3d seen = platform_from_sensor * surface->point;
      const double distance = normal.dot(turned - seen);
      if (std::abs(distance) < limits.max_distance && back.dot(placed[i].normal) > min_agreement) {
        visit(StopResidual{.from = from,
                           .to = pair.to,
                           .distance = distance,
                           .point_from = placed[i].point,
                           .normal_from = back,
                           .point_to = seen,
                           .normal_to = normal});
      }
    }
  }
}

/// The median of the residuals' magnitudes, metres, of those below 20 mm; 0 if there are none.
double median_residual(const TurnViews& turn, const Eigen::Isometry3d& platform_from_sensor,
                       const std::vector<double>& stop_offsets, int threads);

}  // namespace octurn
