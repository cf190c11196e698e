#pragma once

#include <stop_token>
#include <vector>

#include "octurn/register.hpp"
#include "register/free_rays.hpp"
#include "register/stop_view.hpp"

namespace octurn {

/// The observations of one turn, in the turn's frame: the platform's at angle 0.
struct SeenTurn {
  std::vector<StopView> stops = {};
  FreeRays free_rays = {};  ///< of all stops
  /// Mean point and normal of each 2 mm cell with at least three readings, sorted by cell.
  std::vector<SurfacePoint> points = {};
};

/// Reads the depth images of a turn. @throws  as `register_turns`
SeenTurn read_turn(const RegistrationTurn& turn, int threads, const std::stop_token& stop);

/// Returns at most `count` of the points, evenly spaced by index.
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, std::size_t count);

/// The middle of the points' bounding box.
Eigen::Vector3d find_middle(const std::vector<SurfacePoint>& points);

/// Whether a point lies in a turn's free space: at least two stops see through it, or it lies below
/// the platform.
/// @param point  metres, the turn's frame
bool contradicts(const SeenTurn& turn, const Eigen::Vector3d& point);

/// The share of the points that lie in a turn's free space.
/// @param turn_from_points  frame of the points to frame of the turn
double contradicted_share(const SeenTurn& turn, const std::vector<SurfacePoint>& points,
                          const Eigen::Isometry3d& turn_from_points);

}  // namespace octurn
