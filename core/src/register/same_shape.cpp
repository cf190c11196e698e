#include "register/same_shape.hpp"

#include <algorithm>
#include <cmath>

#include "register/seen_turn.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t compared_points = 1500;

// Tolerances of a point on a surface.
constexpr double same_surface = 0.0015;  // metres, along the normal
constexpr double residuals_apart = 3;    // times the residual, where that is more
constexpr double points_to_surface = 2;  // times that, in any direction: an edge has two normals
constexpr double base_height = 0.002;  // metres from a platform, where the object gets a flat base
// On a ball scanned by a Kinect up to 0.9 % of the points lie off the surface: mixed pixels.
constexpr double max_other_share = 0.02;

/// The share of the points that lie on neither of two surfaces.
/// @param a_from_points, b_from_points  frame of the points to frame of the surface
/// @param tolerance      metres, along the normal
double other_share(const NearestPoints& a, const Isometry3d& a_from_points, const NearestPoints& b,
                   const Isometry3d& b_from_points, const std::vector<SurfacePoint>& points,
                   double tolerance) {
  const auto on = [&](const NearestPoints& surface, const Isometry3d& pose,
                      const SurfacePoint& point) {
    const Vector3d at = pose * point.point;
    if (std::abs(at.z()) < base_height) {
      return true;
    }
    const SurfacePoint* const nearest = surface.find(at);
    return nearest != nullptr && (std::abs(nearest->normal.dot(at - nearest->point)) < tolerance ||
                                  (at - nearest->point).norm() < points_to_surface * tolerance);
  };
  const auto others = std::ranges::count_if(points, [&](const SurfacePoint& point) {
    return !on(a, a_from_points, point) && !on(b, b_from_points, point);
  });
  return static_cast<double>(others) / static_cast<double>(points.size());
}

}  // namespace

bool same_shape(const NearestPoints& target, const NearestPoints& turn, const PoseCandidate& one,
                const PoseCandidate& other) {
  const std::vector<SurfacePoint> points = thinned(turn.points(), compared_points);
  const double tolerance =
      std::max(same_surface, residuals_apart * std::min(one.residual, other.residual));
  const auto lies_on = [&](const Isometry3d& there, const Isometry3d& here) {
    return other_share(target, there, turn, here.inverse() * there, points, tolerance) <
           max_other_share;
  };
  return lies_on(other.target_from_points, one.target_from_points) &&
         lies_on(one.target_from_points, other.target_from_points);
}

}  // namespace octurn
