#pragma once

#include <Eigen/Geometry>

#include "laser/line_profile.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A laser's line at one stop, and its pose.
struct PlacedLine {
  const LineProfile& profile;
  const Laser& laser;
  Eigen::Isometry3d object_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
};

/// Joins a line with the lines of the previous and the next stop: two triangles for each pair of
/// neighbouring rows, as neighbouring samples are joined (Bennett 2014, in its discussion of a
/// laser).
///
/// A triangle is left out if a side is longer than 1.5 mm plus the platform's motion there, as it
/// would bridge a gap, or if the camera sees its back.
///
/// @param previous, next  null where there is none
LineStrip make_strip(const PlacedLine& own, const PlacedLine* previous, const PlacedLine* next);

}  // namespace octurn
