#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "register/rigid_fit.hpp"
#include "register/seen_turn.hpp"

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

}  // namespace octurn
