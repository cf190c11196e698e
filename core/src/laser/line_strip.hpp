#pragma once

#include <Eigen/Geometry>

#include "laser/line_profile.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A laser's line at one stop, in its place.
struct PlacedLine {
  const LineProfile& profile;
  const Laser& laser;
  Eigen::Isometry3d object_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
};

/// Joins a line with those of the stops before and after it, each to two triangles for neighbouring
/// rows and neighbouring lines, as the thesis joins samples (Bennett 2014, where it tells what a
/// laser would change).
///
/// Left out are triangles with a side that is longer than 1.5 mm and the way that the platform
/// turned there, as it bridges a gap, and those that the camera sees from behind.
///
/// @param previous, next  null where there is none
LineStrip make_strip(const PlacedLine& own, const PlacedLine* previous, const PlacedLine* next);

}  // namespace octurn
