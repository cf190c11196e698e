#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <vector>

#include "laser/line_profile.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// The laser lines in the pictures of a scan folder. A stop's pictures are read at the first access
/// to its lines; only the lines are kept, 12 bytes for each row that a line crosses.
class LaserLines {
 public:
  /// @param scan  by laser line
  LaserLines(std::filesystem::path folder, Scan scan);

  /// Estimates the memory of the lines of a whole scan, bytes.
  static std::size_t expected_bytes(const Scan& scan);

  const Scan& scan() const { return scan_; }

  /// Width of a pixel on the platform below the centre of the clip box, seen from the first stop,
  /// metres.
  double pixel() const { return pixel_; }

  /// The lines of a stop, one for each laser. Thread-safe.
  /// @throws Error "scan-missing", "snapshot-malformed"
  const std::vector<LineProfile>& at(std::size_t stop) const;

  /// Returns a stop's strips, with the laser planes and the pose for models. Reads the previous and
  /// the next stop of the same pose whose lines are far enough away, too.
  /// @throws Error  as above
  Snapshot snapshot(std::size_t stop) const;

 private:
  struct Stop {
    std::once_flag read = {};
    std::vector<LineProfile> lines = {};
  };
  struct NeighbourStops {
    std::size_t previous = 0;  // index; the stop itself, if its pose has no other
    std::size_t next = 0;
  };

  std::size_t neighbour(std::size_t stop, std::size_t step, double min_turn) const;

  Scan scan_;
  std::filesystem::path folder_;
  double pixel_;
  LineScale scale_;
  std::unique_ptr<Stop[]> stops_;
  std::vector<NeighbourStops> neighbours_ = {};
};

/// A laser's line at one stop, and its pose.
struct PlacedLine {
  const LineProfile& profile;
  const Laser& laser;
  Eigen::Isometry3d object_from_sensor = Eigen::Isometry3d::Identity();  ///< metres
};

/// Joins a line with the lines of the previous and the next stop: two triangles for each pair of
/// neighbouring rows, as neighbouring samples are joined (Bennett 2014, in its discussion of a
/// laser).
///
/// A triangle is left out if a side is longer than 1.5 mm plus the platform's motion there, as it
/// would bridge a gap, or if the camera sees its back.
///
/// @param previous, next  null where there is none
LineStrip make_strip(const PlacedLine& own, const PlacedLine* previous, const PlacedLine* next);

}  // namespace octurn
