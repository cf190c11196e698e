#pragma once

#include "calibrate/stop_residuals.hpp"
#include "core/calibrate/rendered_turn.hpp"

namespace octurn {

/// The platform's true plane in the sensor's frame.
inline PlatformPlane true_plane() {
  const Eigen::Isometry3d sensor_from_platform = true_platform_from_sensor().inverse();
  const Eigen::Vector3d normal = sensor_from_platform.linear() * Eigen::Vector3d::UnitZ();
  return {.normal = normal, .offset = normal.dot(sensor_from_platform.translation())};
}

/// The stops' readings of the object, each counted as independent.
inline TurnViews views_of(const CalibrationTurn& turn, int step = 5) {
  TurnViews views{.angles = turn.angles, .pairs = make_stop_pairs(turn.angles)};
  const ObjectView::Mask mask{.plane = true_plane(),
                              .axis_point = true_platform_from_sensor().inverse().translation()};
  for (std::size_t stop = 0; stop < turn.angles.size(); ++stop) {
    views.views.emplace_back(turn.read(stop), turn.intrinsics, mask);
    views.readings.push_back(views.views.back().readings(step));
  }
  return views;
}

}  // namespace octurn
