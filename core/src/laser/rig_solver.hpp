#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <vector>

#include "laser/laser_rig.hpp"
#include "laser/line_strip.hpp"

namespace octurn {

/// The prior on a rig's deviation from the configured one: one sigma of each kind of unknown.
struct RigTrust {
  double pose_shift = 0;   ///< metres
  double pose_turn = 0;    ///< radians
  double plane_shift = 0;  ///< metres, at the object
  double plane_turn = 0;   ///< radians, about the vertical
  double plane_tilt = 0;   ///< radians, about the horizontal in the plane
};

/// A solved rig.
struct RigSolution {
  LaserRig rig = {};
  Eigen::MatrixXd covariance = {};  ///< of the unknowns of `moved`
  std::vector<float> surface_distances =
      {};  ///< metres: distances between the surfaces of two lasers
  std::vector<float> platform_heights = {};  ///< metres: magnitudes of the heights on the platform
  double cost = 0;  ///< mean of ln(1 + (r / 0.1 mm)^2) over both kinds, to compare solutions
};

/// The platform stood further on than configured, from a stop on.
struct Slip {
  std::size_t stop = 0;
  double angle = 0;      ///< radians
  double explained = 0;  ///< share of the squared distances between points before it and after it
};

/// Solves the pose of the camera and the planes of the lasers from the lines of a turn.
///
/// Gauss-Newton with Cauchy weights and three kinds of residuals. A point of one laser's line,
/// rotated back by its stop's angle, must lie on the surface that the other lasers measured (point
/// to plane). Lines on the platform must lie at height 0. The configured rig is a prior with the
/// sigmas of `RigTrust`.
class RigSolver {
 public:
  /// Reads all lines. @throws  as `LaserLines::at`
  /// @param configured  start of the iteration and mean of the prior
  RigSolver(const LaserLines& lines, LaserRig configured, int threads,
            const std::stop_token& stop = {});

  RigSolution solve(const RigTrust& trust) const;

  /// Evaluates the configured rig.
  RigSolution as_told() const;

  /// Returns the slip that explains most of the distances between the surfaces of two lasers; none
  /// if too few points were seen before and after it.
  /// @param only  the stop to look at
  std::optional<Slip> find_slip(const LaserRig& rig, std::optional<std::size_t> only = {}) const;

  /// Sets how far the platform had slipped at each stop, radians.
  void set_slipped(std::span<const double> slipped);

  /// Returns the share of the surface points that another laser confirms, had the platform turned
  /// by `turn_ratio` times the configured angles.
  double confirmed_share(const LaserRig& rig, double turn_ratio) const;

  /// The number of points on the platform.
  std::size_t platform_points() const { return platform_.size(); }

 private:
  struct PlatformPoint {
    std::size_t laser = 0;
    LineProfile::Ray ray = {};
  };
  struct Reading {
    PlatformPoint point = {};
    double height = 0;  // metres, platform frame as configured
    double radius = 0;  // metres from the platform's axis
  };
  struct Sums;
  struct Equations;

  /// Points of two lasers near each other.
  struct Pair {
    const LinePoint& from;
    const LinePoint& to;
    std::size_t from_laser = 0;
    std::size_t to_laser = 0;

    /// The distance of `from` from the surface at `to`, metres.
    double distance() const;
  };

  std::size_t visit_pairs(const LaserRig& rig, std::span<const double> angles,
                          const std::function<void(const Pair&)>& visit) const;

  Equations linearise(const LaserRig& rig, double scale, RigSolution& solution) const;
  std::vector<Reading> read_all();
  void find_platform();
  static double usual_height(const std::vector<Reading>& readings);
  static double object_radius(const std::vector<Reading>& readings, double height);
  void add_platform(const LaserRig& rig, double scale, Sums& sums) const;
  void add_surfaces(const LaserRig& rig, double scale, Sums& sums) const;

  const LaserLines& lines_;
  std::stop_token stop_;
  LaserRig told_;
  std::vector<double> angles_ = {};  // of the platform at each stop, radians
  Pivots pivots_ = {};
  std::vector<PlatformPoint> platform_ = {};
};

}  // namespace octurn
