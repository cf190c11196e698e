#include "laser/laser_rig.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "laser/line_strip.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

/// Derivatives of a plane's normal with respect to its two rotations.
struct PlaneTurns {
  Vector3d about_z;
  Vector3d about_level;

  PlaneTurns(const Eigen::Isometry3d& platform_from_sensor, const Vector3d& normal) {
    const Vector3d up = platform_from_sensor.linear().transpose() * Vector3d::UnitZ();
    about_z = up.cross(normal);
    about_level = normal.cross(up).normalized().cross(normal);
  }
};

}  // namespace

LaserRig moved(const LaserRig& rig, const Pivots& pivots, const Eigen::VectorXd& change) {
  LaserRig to = rig;
  const Vector3d rotation(change[0], change[1], 0);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (const double angle = rotation.norm(); angle > 0) {
    motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  }
  motion.translation() = change.segment<3>(2);
  to.platform_from_sensor = motion * rig.platform_from_sensor;
  for (std::size_t i = 0; i < to.lasers.size(); ++i) {
    const auto first = pose_unknowns + plane_unknowns * static_cast<Eigen::Index>(i);
    Laser& laser = to.lasers[i];
    const PlaneTurns turns(rig.platform_from_sensor, laser.normal);
    const double shift = change[first + 2] + laser.distance - laser.normal.dot(pivots[i]);
    laser.normal =
        (laser.normal + change[first] * turns.about_z + change[first + 1] * turns.about_level)
            .normalized();
    laser.distance = laser.normal.dot(pivots[i]) + shift;
  }
  return to;
}

SeenPoint::SeenPoint(const LaserRig& rig, const Pivots& pivots, std::size_t laser,
                     const LineProfile::Ray& ray)
    : laser_(laser) {
  const Laser& of = rig.lasers[laser];
  const Vector3d point = meet(ray, of);
  const Vector3d along(static_cast<double>(ray.x), static_cast<double>(ray.y), 1);
  const PlaneTurns turns(rig.platform_from_sensor, of.normal);
  const Vector3d from_pivot = point - pivots[laser];
  // n . (z r) = d with d = n . pivot + shift: z changes by (shift - dn . (p - pivot)) / (n . r).
  const double across = of.normal.dot(along);
  depth_per_unit_ =
      Vector3d(-turns.about_z.dot(from_pivot), -turns.about_level.dot(from_pivot), 1) / across;
  in_platform_ = rig.platform_from_sensor * point;
  ray_ = rig.platform_from_sensor.linear() * along;
}

void SeenPoint::add_row(const Vector3d& along, double factor, Eigen::VectorXd& row) const {
  const Vector3d turning = in_platform_.cross(along);
  row[0] += factor * turning.x();
  row[1] += factor * turning.y();
  row.segment<3>(2) += factor * along;
  const auto first = pose_unknowns + plane_unknowns * static_cast<Eigen::Index>(laser_);
  row.segment<3>(first) += factor * along.dot(ray_) * depth_per_unit_;
}

namespace {

using Eigen::Vector3f;

constexpr float cell_side = 0.0025F;  // metres
constexpr float max_distance = 0.0025F;
constexpr float min_agreement = 0.7F;  // cosine between two normals

using Cell = std::array<int, 3>;

Cell to_cell(const Vector3f& point) {
  const auto at = [&](int axis) { return static_cast<int>(std::floor(point[axis] / cell_side)); };
  return {at(0), at(1), at(2)};
}

std::uint64_t to_key(const Cell& cell) {
  constexpr int offset = 1 << 20;
  const auto part = [](int at) { return static_cast<std::uint64_t>(at + offset) & 0x1fffffU; };
  return part(cell[0]) | part(cell[1]) << 21U | part(cell[2]) << 42U;
}

}  // namespace

LinePoints::LinePoints(const LaserLines& lines, const LaserRig& rig, std::size_t laser,
                       std::span<const double> angles, double min_height) {
  const auto placed = [&](std::size_t stop) -> PlacedLine {
    return {.profile = lines.at(stop)[laser],
            .laser = rig.lasers[laser],
            .object_from_sensor = object_from_sensor(rig.platform_from_sensor, angles[stop])};
  };
  for (std::size_t stop = 0; stop < angles.size(); ++stop) {
    const PlacedLine next = placed((stop + 1) % angles.size());
    const PlacedLine own = placed(stop);
    add_stop(make_strip(own, nullptr, &next), stop, min_height,
             own.object_from_sensor.translation().cast<float>());
  }
  cells_.reserve(points_.size());
  for (std::uint32_t i = 0; i < points_.size(); ++i) {
    cells_.push_back({.cell = to_key(to_cell(points_[i].point)), .point = i});
  }
  std::ranges::sort(cells_);
}

void LinePoints::add_stop(const LineStrip& strip, std::size_t stop, double min_height,
                          const Vector3f& camera) {
  std::vector<Vector3f> normals(strip.own_points, Vector3f::Zero());
  for (const LineStrip::Triangle& triangle : strip.to_next) {
    const Vector3f& a = strip.points[triangle[0]];
    Vector3f normal = (strip.points[triangle[1]] - a).cross(strip.points[triangle[2]] - a);
    if (normal.dot(camera - a) < 0) {
      normal = -normal;
    }
    for (const std::uint32_t corner : triangle) {
      if (corner < strip.own_points) {
        normals[corner] += normal;
      }
    }
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const float length = normals[i].norm();
    if (length > 0 && static_cast<double>(strip.points[i].z()) > min_height) {
      points_.push_back({.point = strip.points[i],
                         .normal = normals[i] / length,
                         .stop = static_cast<std::uint32_t>(stop),
                         .ray = static_cast<std::uint32_t>(i)});
    }
  }
}

const LinePoint* LinePoints::nearest(const Vector3f& point, const Vector3f& normal) const {
  const Cell middle = to_cell(point);
  std::uint32_t best = 0;
  float best_square = max_distance * max_distance;
  bool found = false;
  // Neighbouring cells along X have consecutive keys: one search finds all three.
  for (int i = 0; i < 9; ++i) {
    const Cell cell{middle[0] - 1, middle[1] + i % 3 - 1, middle[2] + i / 3 - 1};
    const std::uint64_t last = to_key({middle[0] + 1, cell[1], cell[2]});
    for (auto at = std::ranges::lower_bound(cells_, to_key(cell), {}, &CellEntry::cell);
         at != cells_.end() && at->cell <= last; ++at) {
      const LinePoint& other = points_[at->point];
      const float square = (other.point - point).squaredNorm();
      // Ties go to the lower index, whatever the order of the cells is.
      const bool nearer =
          square < best_square || (found && square == best_square && at->point < best);
      if (nearer && other.normal.dot(normal) > min_agreement) {
        best = at->point;
        best_square = square;
        found = true;
      }
    }
  }
  return found ? &points_[best] : nullptr;
}

}  // namespace octurn
