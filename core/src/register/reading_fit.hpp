#pragma once

#include <Eigen/Geometry>
#include <span>
#include <stop_token>
#include <vector>

#include "register/rigid_fit.hpp"
#include "register/seen_turn.hpp"
#include "register/stop_view.hpp"

namespace octurn {

/// A turn whose pose in the object's frame is known.
struct PlacedTurn {
  const SeenTurn* turn = nullptr;
  Eigen::Isometry3d object_from_turn = Eigen::Isometry3d::Identity();
};

/// The pose of a turn that fits the readings of its stops best.
struct ReadingFit {
  Eigen::Isometry3d object_from_turn = Eigen::Isometry3d::Identity();
  double position_sigma = 0;   ///< metres, of the middle
  double direction_sigma = 0;  ///< radians
  double residual = 0;         ///< metres, median of the distances' magnitudes
};

/// Refines a turn's pose on readings: each reading of its stops is compared with the surface that
/// stops of the placed turns saw there, and the other way round (Gauss-Newton, point to plane).
///
/// @param start   frame of the turn to the object's frame
/// @param middle  metres, object's frame: centre of the turn's points, about which it is rotated
ReadingFit fit_readings(std::span<const PlacedTurn> placed, const SeenTurn& turn,
                        const Eigen::Isometry3d& start, const Eigen::Vector3d& middle, int threads,
                        const std::stop_token& stop);

/// The points of a flat foot, on which an object stands, and the plane of its platform.
struct Contact {
  std::vector<Eigen::Vector3d> foot = {};         ///< metres, frame of the points
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< the platform's normal, frame of the points
  double height = 0;                              ///< metres, of the platform along its normal
};

/// Finds the foot on which the object stands in one turn, among the points of another turn, which
/// saw it. For a block the foot is the only constraint on the height. A face that is curved,
/// smaller than 4 cm2, or not the lowest is no foot, as the platform may touch the object
/// elsewhere.
///
/// @param share  0 to 1: `points` are this share of the other turn's points
/// @return an empty foot if there is none
Contact find_contact(const std::vector<SurfacePoint>& points,
                     const Eigen::Isometry3d& platform_from_points, double share);

/// Adds the constraint that the foot lies on its platform, to a fit that moves the foot's points.
/// @param object_from_points  frame of the contact to frame of the fit
void add_moving_foot(RigidFit& fit, const Contact& contact,
                     const Eigen::Isometry3d& object_from_points, double of_weight);

/// Adds the same constraint to a fit that moves the platform.
void add_moving_platform(RigidFit& fit, const Contact& contact,
                         const Eigen::Isometry3d& object_from_points, double of_weight);

}  // namespace octurn
