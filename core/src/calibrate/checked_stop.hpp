#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "calibrate/object_view.hpp"
#include "octurn/quality.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

/// A cell of a grid in the object's frame, by its number along x, y and z from the origin.
using ObjectCell = std::array<std::int16_t, 3>;

/// Metres: side of a cell. Two stops see one surface within less.
inline constexpr double object_cell_side = 0.005;

/// @param point  metres, object's frame
ObjectCell to_object_cell(const Eigen::Vector3d& point);

/// The centre of a cell: metres, object's frame.
Eigen::Vector3d find_middle(const ObjectCell& cell);

/// The cells that more than one stop has, in their order.
/// @param stops  the cells of each, none twice
std::vector<ObjectCell> cells_of_several(std::span<const std::vector<ObjectCell>* const> stops);

/// The samples of a snapshot that `ScanCheck` keeps.
struct ScanCheck::Stop {
  Stop(const Snapshot& snapshot, const Box& clip);

  static constexpr int thinning = 2;       ///< every other row and column is kept
  static constexpr double highest = 0.03;  ///< metres: `heights` go from -highest to it
  static constexpr double height_step = 0.001;

  /// Metres along z: depth up to which the pixels around a point's pixel see free space; 0 if one
  /// of them has no reading.
  /// @param point  metres, optical frame
  double empty_depth(const Eigen::Vector3d& point) const;

  /// An image whose pixels are blocks of another image's pixels.
  struct Blocks {
    Intrinsics lens = {};
    std::vector<float> nearest = {};  ///< metres along z, row by row; 0 as `empty_depth`
  };

  Eigen::Isometry3d object_from_sensor;
  Blocks blocks;
  ObjectView view;                            ///< of every other row and column
  std::vector<SurfaceReading> readings = {};  ///< of the object, inside the box
  std::size_t object_pixels = 0;              ///< inside the box
  double depths = 0;                          ///< metres, their sum over object pixels
  /// Metres, object's frame: pixels at which the box cuts, as in `ScanFigures::cut_pixels`.
  std::array<std::vector<Eigen::Vector3f>, 5> cut = {};
  std::vector<ObjectCell> seen = {};  ///< cells with readings of a surface inside the box
  double unseen_top = 0;              ///< metres, as in `ScanFigures`
  std::vector<std::size_t> heights;   ///< of readings near z = 0, a count for each step

 private:
  Stop(const Snapshot& thin, const Box& clip, const ObjectView::Mask& mask);
  void add_line(const LineStrip& strip, const Box& clip);
  void add_height(const Eigen::Vector3d& point, std::size_t count);
};

/// Result of comparing the stops.
struct StopComparison {
  double disagreement = 0;  ///< metres: the median of the distances
  /// As in `ScanFigures`.
  std::vector<double> contradicted = {};
  DifferingPlaces differing = {};
};

/// Compares each stop's readings of the object with the surfaces that neighbouring stops saw.
StopComparison compare_stops(const std::vector<const ScanCheck::Stop*>& stops,
                             const SensorTraits& sensor, int threads);

/// Compares leaves of a hollow shell with the surfaces that the stops saw.
/// @param leaves  metres, object's frame
ShellFigures compare_shell(const std::vector<const ScanCheck::Stop*>& stops,
                           std::span<const Eigen::Vector3d> leaves);

}  // namespace octurn
