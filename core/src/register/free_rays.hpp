#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "octurn/snapshot.hpp"

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

}  // namespace octurn
