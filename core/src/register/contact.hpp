#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "register/rigid_fit.hpp"
#include "register/stop_view.hpp"

namespace octurn {

/// Points of a flat foot, and the platform that it stood on.
struct Contact {
  std::vector<Eigen::Vector3d> foot = {};  ///< metres, frame of the points
  /// The platform's normal, frame of the points; and how far along it the platform is.
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  double height = 0;
};

/// Looks among points for a face that lies flat on a platform which another turn stood on: the one
/// part of a block that tells how high it stood. A face that is curved, small, or not the lowest of
/// what was seen is left out: the platform may touch the object elsewhere.
///
/// @param share  of all points that these are
/// @return no foot, if there is none
Contact find_contact(const std::vector<SurfacePoint>& points,
                     const Eigen::Isometry3d& platform_from_points, double share);

/// Adds what a foot says to a fit that moves its points.
/// @param object_from_points  takes the contact's frame to the fit's
void add_moving_foot(RigidFit& fit, const Contact& contact,
                     const Eigen::Isometry3d& object_from_points, double of_weight);

/// Adds what a foot says to a fit that moves its platform.
void add_moving_platform(RigidFit& fit, const Contact& contact,
                         const Eigen::Isometry3d& object_from_points, double of_weight);

}  // namespace octurn
