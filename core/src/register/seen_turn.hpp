#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "octurn/register.hpp"
#include "octurn/snapshot.hpp"
#include "register/stop_view.hpp"

namespace octurn {

/// The minimum reading of each block of 4 x 4 pixels, in depth units, row by row; 0 where fewer
/// than half of the pixels have a reading.
using FreeDepths = std::vector<std::uint16_t>;

/// @param frame  of the intrinsics' size
FreeDepths find_free_depths(const DepthFrame& frame);

/// The free space along the rays of all stops of a turn.
class FreeRays {
 public:
  FreeRays() = default;

  /// @param lens               of all stops
  /// @param sensors_from_turn  optical frame of each stop from the turn's frame
  /// @param depths             of each stop
  FreeRays(const Intrinsics& lens, std::span<const Eigen::Isometry3d> sensors_from_turn,
           std::vector<FreeDepths> depths);

  /// Whether at least `min_stops` stops see through a point: all readings of the block of pixels
  /// that it projects to are more than 6 mm behind it. @param point  metres, the turn's frame
  bool pass(const Eigen::Vector3d& point, int min_stops) const;

 private:
  static constexpr std::size_t at_once = 8;
  template <typename Value>
  using Each = std::array<Value, at_once>;

  /// The poses of eight stops as a structure of arrays, for SIMD.
  struct Poses {
    std::array<std::array<Each<double>, 4>, 3> rows = {};
  };
  /// The projections of a point into these stops: pixels, whose centres lie at a half, and metres
  /// along the optical axis.
  struct Seen {
    Each<double> u;
    Each<double> v;
    Each<double> z;
  };

  static void see(const Intrinsics& lens, const Poses& poses, const Eigen::Vector3d& point,
                  Seen& seen);
  bool passes(std::size_t stop, double u, double v, double z) const;

  Intrinsics lens_ = {};
  std::vector<Poses> poses_ = {};
  std::vector<FreeDepths> depths_ = {};
};

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
