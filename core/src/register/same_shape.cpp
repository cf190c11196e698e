#include "register/same_shape.hpp"

#include <algorithm>
#include <cmath>

#include "register/seen_turn.hpp"

namespace octurn {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr std::size_t compared_points = 1500;

// Two answers give the same shape if nearly all that the one shows lies on the other.
constexpr double same_surface = 0.0015;  // metres, along the normal
constexpr double same_point = 0.003;     // metres, whatever the normal: near an edge there are two
constexpr double foot = 0.002;           // metres from a platform: a flat foot is made there
constexpr double max_other_share = 0.04;

/// Share of points that neither of two surfaces has.
/// @param b_from_points  the second surface's frame from the points'
double other_share(const NearestPoints& a, const Isometry3d& a_from_points, const NearestPoints& b,
                   const Isometry3d& b_from_points, const std::vector<SurfacePoint>& points) {
  const auto on = [](const NearestPoints& surface, const Isometry3d& pose,
                     const SurfacePoint& point) {
    const Vector3d at = pose * point.point;
    if (std::abs(at.z()) < foot) {
      return true;
    }
    const SurfacePoint* const nearest = surface.find(at);
    return nearest != nullptr &&
           (std::abs(nearest->normal.dot(at - nearest->point)) < same_surface ||
            (at - nearest->point).norm() < same_point);
  };
  const auto others = std::ranges::count_if(points, [&](const SurfacePoint& point) {
    return !on(a, a_from_points, point) && !on(b, b_from_points, point);
  });
  return static_cast<double>(others) / static_cast<double>(points.size());
}

}  // namespace

bool same_shape(const NearestPoints& target, const NearestPoints& turn, const Isometry3d& one,
                const Isometry3d& other) {
  const std::vector<SurfacePoint> points = thinned(turn.points(), compared_points);
  return other_share(target, other, turn, one.inverse() * other, points) < max_other_share &&
         other_share(target, one, turn, other.inverse() * one, points) < max_other_share;
}

}  // namespace octurn
