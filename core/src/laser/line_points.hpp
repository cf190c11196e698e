#pragma once

#include <Eigen/Core>
#include <compare>
#include <cstdint>
#include <vector>

#include "laser/laser_lines.hpp"
#include "laser/laser_rig.hpp"

namespace octurn {

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
  /// @param min_height  metres above the rig's platform: lower points may be the platform's
  LinePoints(const LaserLines& lines, const LaserRig& rig, std::size_t laser, double min_height);

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
