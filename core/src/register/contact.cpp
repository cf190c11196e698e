#include "register/contact.hpp"

#include <algorithm>
#include <cmath>

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr double max_gap = 0.012;          // metres between foot and platform before the fit
constexpr double min_facing = 0.99;        // cosine between the foot's normal and straight down
constexpr double min_area_cells = 100;     // of 2 mm: 4 cm2
constexpr double max_spread = 0.0003;      // metres, of the foot's heights
constexpr double max_below_foot = 0.0015;  // metres below the foot that noise explains
constexpr double max_below_share = 0.02;

/// Adds a point-to-plane equation for each point of a foot: its distance from the platform is 0.
/// @param side  1 if the foot moves, -1 if the platform moves
void add_rows(RigidFit& fit, const Contact& contact, const Eigen::Isometry3d& object_from_points,
              double side, double of_weight) {
  const Vector3d normal = object_from_points.linear() * contact.up;
  for (const Vector3d& point : contact.foot) {
    const double distance = contact.up.dot(point) - contact.height;
    fit.add(object_from_points * point, side * normal, distance, of_weight);
  }
}

}  // namespace

Contact find_contact(const std::vector<SurfacePoint>& points,
                     const Eigen::Isometry3d& platform_from_points, double share) {
  Contact contact{.foot = {},
                  .up = platform_from_points.linear().row(2).transpose(),
                  .height = -platform_from_points.translation().z()};
  const auto height_above = [&](const Vector3d& point) {
    return contact.up.dot(point) - contact.height;
  };
  double sum = 0;
  double squares = 0;
  for (const SurfacePoint& point : points) {
    const double above = height_above(point.point);
    if (std::abs(above) < max_gap && contact.up.dot(point.normal) < -min_facing) {
      contact.foot.push_back(point.point);
      sum += above;
      squares += above * above;
    }
  }
  const auto count = static_cast<double>(contact.foot.size());
  if (count < min_area_cells * share ||
      squares / count - sum / count * sum / count > max_spread * max_spread) {
    contact.foot.clear();
    return contact;
  }
  const auto below =
      static_cast<double>(std::ranges::count_if(points, [&](const SurfacePoint& point) {
        return height_above(point.point) < sum / count - max_below_foot;
      }));
  if (below > max_below_share * count) {
    contact.foot.clear();
  }
  return contact;
}

void add_moving_foot(RigidFit& fit, const Contact& contact,
                     const Eigen::Isometry3d& object_from_points, double of_weight) {
  add_rows(fit, contact, object_from_points, 1, of_weight);
}

void add_moving_platform(RigidFit& fit, const Contact& contact,
                         const Eigen::Isometry3d& object_from_points, double of_weight) {
  add_rows(fit, contact, object_from_points, -1, of_weight);
}

}  // namespace octurn
