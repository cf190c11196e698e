#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "laser/line_profile.hpp"
#include "laser/line_strip.hpp"

namespace octurn {

/// The pose of a camera and the planes of its lasers, which a calibration solves.
struct LaserRig {
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
  std::vector<Laser> lasers = {};
};

/// The unknowns of a small change of a rig. The sensor's pose, in the platform frame: rotation
/// about x and y (radians), shift along x, y and z (metres); the rotation about the platform's axis
/// is not observable. Then for each laser's plane: rotation about the platform's Z and about the
/// horizontal line in the plane, both through the laser's pivot (radians), and shift along its
/// normal (metres).
inline constexpr Eigen::Index pose_unknowns = 5;
inline constexpr Eigen::Index plane_unknowns = 3;

/// The pivot of each laser's plane: the mean of the points on its line, metres, optical frame.
using Pivots = std::vector<Eigen::Vector3d>;

/// The rig after a small change.
LaserRig moved(const LaserRig& rig, const Pivots& pivots, const Eigen::VectorXd& change);

/// A point on a laser's line, and its derivatives with respect to the unknowns.
class SeenPoint {
 public:
  /// @param laser  index of the laser whose plane the ray meets
  SeenPoint(const LaserRig& rig, const Pivots& pivots, std::size_t laser,
            const LineProfile::Ray& ray);

  const Eigen::Vector3d& in_platform() const { return in_platform_; }

  /// Adds a row of the Jacobian: the derivatives of the point's coordinate along a direction, times
  /// `factor`. @param along  direction, platform frame
  void add_row(const Eigen::Vector3d& along, double factor, Eigen::VectorXd& row) const;

 private:
  std::size_t laser_;
  Eigen::Vector3d in_platform_;
  Eigen::Vector3d ray_;             // in the platform frame's axes
  Eigen::Vector3d depth_per_unit_;  // derivatives of z by the plane's three unknowns
};

/// A point on a laser's line, and the surface's normal there.
struct LinePoint {
  Eigen::Vector3f point = Eigen::Vector3f::Zero();   ///< metres, object's frame
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< of length one, towards the camera
  std::uint32_t stop = 0;
  std::uint32_t ray = 0;  ///< index in the stop's profile
};

/// The surface points of an object measured with one laser, in a grid for nearest-neighbour search.
class LinePoints {
 public:
  /// @param lines  already read at all stops
  /// @param angles  of the platform at each stop, radians
  /// @param min_height  metres above the rig's platform: lower points may be the platform's
  LinePoints(const LaserLines& lines, const LaserRig& rig, std::size_t laser,
             std::span<const double> angles, double min_height);

  const std::vector<LinePoint>& all() const { return points_; }

  /// The nearest point within 2.5 mm whose normal agrees within 45 degrees; null if there is none.
  const LinePoint* nearest(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;

 private:
  void add_stop(const LineStrip& strip, std::size_t stop, double min_height,
                const Eigen::Vector3f& camera);

  std::vector<LinePoint> points_ = {};
  struct CellEntry {
    std::uint64_t cell = 0;
    std::uint32_t point = 0;  // index in `points_`

    auto operator<=>(const CellEntry&) const = default;
  };
  std::vector<CellEntry> cells_ = {};  // sorted
};

}  // namespace octurn
