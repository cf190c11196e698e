#pragma once

#include <stop_token>
#include <vector>

#include "octurn/register.hpp"
#include "register/free_rays.hpp"
#include "register/stop_view.hpp"

namespace octurn {

/// What one turn saw of the object, in its own frame: the platform's at angle 0.
struct SeenTurn {
  std::vector<StopView> stops = {};
  FreeRays free_rays = {};  ///< of all stops
  /// Means of the readings in cells of 2 mm that several readings fell in, in a fixed order.
  std::vector<SurfacePoint> points = {};
};

/// Reads the depth images of a turn. @throws  as `register_turns`
SeenTurn read_turn(const RegistrationTurn& turn, int threads, const std::stop_token& stop);

/// Every n-th of the points, so that about `count` remain.
std::vector<SurfacePoint> thinned(const std::vector<SurfacePoint>& points, std::size_t count);

/// The middle of the points' bounding box.
Eigen::Vector3d find_middle(const std::vector<SurfacePoint>& points);

/// Whether a turn saw a point to be empty space: several of its stops saw through it, or it lies
/// below the turn's platform.
/// @param point  metres, the turn's frame
bool contradicts(const SeenTurn& turn, const Eigen::Vector3d& point);

/// Share of the points that lie where a turn saw empty space.
/// @param turn_from_points  takes the points to the turn's frame
double contradicted_share(const SeenTurn& turn, const std::vector<SurfacePoint>& points,
                          const Eigen::Isometry3d& turn_from_points);

}  // namespace octurn
