#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "register/rigid_fit.hpp"
#include "register/stop_view.hpp"

namespace octurn {

/// Points of a flat foot, and the platform that it stood on.
struct Contact {
  std::vector<Eigen::Vector3d> foot = {};         ///< metres, frame of the points
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< the platform's normal, frame of the points
  double height = 0;                              ///< metres, of the platform along its normal
};

/// Finds the flat face on which the object stood on a turn's platform, among the points that
/// another turn saw. For a block it is the only part that fixes the height. A face that is curved,
/// small, or not the lowest is no foot, as the platform may touch the object elsewhere.
///
/// @param share  of all points that these are
/// @return an empty foot if there is none
Contact find_contact(const std::vector<SurfacePoint>& points,
                     const Eigen::Isometry3d& platform_from_points, double share);

/// Adds the constraint that the foot lies on its platform, to a fit that moves the foot's points.
/// @param object_from_points  takes the contact's frame to the fit's
void add_moving_foot(RigidFit& fit, const Contact& contact,
                     const Eigen::Isometry3d& object_from_points, double of_weight);

/// The same, to a fit that moves the platform.
void add_moving_platform(RigidFit& fit, const Contact& contact,
                         const Eigen::Isometry3d& object_from_points, double of_weight);

}  // namespace octurn
