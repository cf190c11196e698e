#pragma once

#include <cstddef>
#include <stop_token>
#include <vector>

#include "laser/laser_lines.hpp"
#include "laser/laser_rig.hpp"

namespace octurn {

/// How far a rig may be from what was told, one sigma.
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
  std::vector<float> between = {};  ///< metres: what two lasers saw of the object lies so far apart
  std::vector<float> platform = {};  ///< metres: heights of what is seen of the platform
  double cost = 0;  ///< mean of ln(1 + (r / 0.1 mm)^2) over both kinds, to compare solutions
};

/// Solves where camera and lasers stand from the lines of a turn.
///
/// Two kinds of residuals, by Gauss-Newton, weighted as Cauchy distributed: a point of one laser's
/// line, turned back by its stop's angle, must lie on the surface that the other lasers showed of
/// the object (point to plane); and the lines on the platform must lie at height 0. What was told,
/// with how far it is trusted, is a third.
class RigSolver {
 public:
  /// Reads all lines. @throws  as `LaserLines::at`
  /// @param told  where to start
  RigSolver(const LaserLines& lines, LaserRig told, int threads, const std::stop_token& stop = {});

  RigSolution solve(const RigTrust& trust) const;

  /// How what was told fits.
  RigSolution as_told() const;

  /// Points of lines on the platform.
  std::size_t platform_points() const { return platform_.size(); }

 private:
  struct PlatformPoint {
    std::size_t laser = 0;
    LineProfile::Ray ray = {};
  };
  struct Reading {
    PlatformPoint point = {};
    double height = 0;  // metres, platform frame as told
    double radius = 0;  // metres from its axis
  };
  struct Sums;
  struct Look;

  Look look(const LaserRig& rig, double scale, RigSolution& solution) const;
  std::vector<Reading> read_all();
  void find_platform();
  static double usual_height(const std::vector<Reading>& readings);
  static double object_radius(const std::vector<Reading>& readings, double height);
  void add_platform(const LaserRig& rig, double scale, Sums& sums) const;
  void add_surfaces(const LaserRig& rig, double scale, Sums& sums) const;

  const LaserLines& lines_;
  std::stop_token stop_;
  LaserRig told_;
  Pivots pivots_ = {};
  std::vector<PlatformPoint> platform_ = {};
};

}  // namespace octurn
