#pragma once

#include <Eigen/Core>
#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <vector>

#include "octurn/reconstruct.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// Where in space something is, coarsely: the cells of a grid that hold points. Their side begins
/// with 4 mm, and doubles when there are more of them than `max_count`. The order of the points has
/// no influence.
class Places {
 public:
  static constexpr std::size_t max_count = 300;

  /// @param point  metres
  void add(const Eigen::Vector3d& point);

  /// Points of a facet of any size, spread so that none of its cells is left out by much.
  /// @param corners  metres
  void add(const std::array<Eigen::Vector3d, 3>& corners);

  /// Metres, in the order of x, then y, then z.
  std::vector<Eigen::Vector3d> centres() const;

 private:
  using Cell = std::array<int, 3>;

  double side_ = 0.004;  // metres
  std::set<Cell> cells_ = {};
};

/// The cells of a grid that a surface passes through, one bit each. Their side begins with 4 mm,
/// and doubles when there are more than `max_bricks` bricks of 8 x 8 x 8. The order of what is
/// added has no influence.
class SurfaceCells {
 public:
  static constexpr std::size_t max_bricks = 2048;  // some 250 kB; an object of 28 cm has 500

  /// @param point  metres
  void add(const Eigen::Vector3d& point);

  /// A facet of any size: points spread over it, a cell's side apart.
  /// @param corners  metres
  void add(const std::array<Eigen::Vector3d, 3>& corners);

  /// Whether a cell with a piece of the surface is within a distance.
  /// @param point     metres
  /// @param distance  metres, not negative
  bool has_near(const Eigen::Vector3d& point, double distance) const;

  bool empty() const { return bricks_.empty(); }

 private:
  using Cell = std::array<int, 3>;
  using Brick = std::bitset<512>;

  struct PlacedBrick {
    Cell place = {};
    Brick cells = {};
  };

  /// The first brick that is not before a place.
  std::vector<PlacedBrick>::const_iterator lower_bound(const Cell& place) const;
  bool has(const Cell& cell) const;
  void set(const Cell& cell);
  void make_coarser();

  double side_ = 0.004;                   // metres
  std::vector<PlacedBrick> bricks_ = {};  // in the order of their places
  std::optional<Cell> last_ = {};         // that was added: the next point is often in the same
};

/// Checks and measures a surface while it streams by, in constant memory.
class MeshCheck {
 public:
  void add(std::span<const Facet> facets);

  std::uint64_t facets() const { return facets_; }

  /// Whether every directed edge is met by its opposite, corners compared bit by bit.
  ///
  /// Each directed edge (a, b) adds a 64-bit hash h(a, b) - h(b, a), so that a pair of opposites
  /// cancels; an open surface leaves 0 with a chance of 2^-64.
  bool closed() const { return facets_ > 0 && edges_ == 0; }

  /// Cubic millimetres, by the divergence theorem; right only if the surface is closed.
  double volume_mm3() const { return six_volumes_ / 6; }

  /// The share of the surface's area in facets that are marked as filled in, 0 to 1.
  double filled_share() const { return area_ > 0 ? filled_area_ / area_ : 0; }

  /// The same of the area above the base, the facets that lie in z = 0.
  double unseen_share() const {
    return area_ > base_area_ ? (filled_area_ - filled_base_area_) / (area_ - base_area_) : 0;
  }

  /// Metres: where the surface above the base is filled in.
  std::vector<Eigen::Vector3d> unseen_places() const { return unseen_places_.centres(); }

  /// Where the surface is, coarsely.
  const SurfaceCells& surface() const { return surface_; }

  /// The bounding box of all corners, millimetres.
  const Box& bounds_mm() const { return bounds_mm_; }

 private:
  std::uint64_t facets_ = 0;
  std::uint64_t edges_ = 0;
  double six_volumes_ = 0;
  double area_ = 0;  // all areas twice, mm2
  double filled_area_ = 0;
  double base_area_ = 0;
  double filled_base_area_ = 0;
  Places unseen_places_ = {};
  SurfaceCells surface_ = {};
  Box bounds_mm_ = {};
};

/// Where a model is what, for its verdict.
struct ModelPlaces {
  std::vector<Eigen::Vector3d> unseen = {};  ///< metres: where what is above the base is filled in
  SurfaceCells surface = {};
};

/// Connected components that are not in a model.
struct DroppedParts {
  std::uint64_t count = 0;
  double volume = 0.0;  ///< cubic metres
};

/// The figures of a finished model.
struct ModelReport {
  std::uint64_t leaves = 0;  ///< occupied leaves, or voxels inside
  std::uint64_t triangles = 0;
  std::uint64_t bytes = 0;  ///< of the STL
  std::uint64_t parts = 0;  ///< connected components; 0: not counted
  double filled_share = 0;  ///< of the area, made by hole filling, 0 to 1
  double unseen_share = 0;  ///< the same of the area above the base
  ModelPlaces places = {};
  bool watertight = false;  ///< as `MeshCheck::closed`
  double volume = 0.0;      ///< cubic metres
  DroppedParts dropped = {};
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< metres, of the bounding box
  double bottom = 0.0;                             ///< metres, of that box, above z = 0
};

/// The figures of a surface that was counted and checked while it was made.
ModelReport report_of(const SurfaceCount& count, const MeshCheck& check);

/// @throws Error "empty"  if there is no facet
void expect_facets(const SurfaceCount& count);

/// Streams the surface to `sink`.
///
/// @param snapshots  those that were added
/// @return nothing if stopped before the end, by `stop` or by a `Stopped` of the source or sink
/// @throws Error "empty"  if there is no surface
/// @throws  as `Reconstructor::surface`
std::optional<SurfaceCount> write_model(Reconstructor& reconstructor,
                                        const SnapshotSource& snapshots, const FacetSink& sink,
                                        const std::stop_token& stop);

/// Writes the surface as binary STL, which appears whole or not at all, and checks it on the way.
///
/// @return nothing, and no file, if stopped before the end
/// @throws Error  as above; "disk-full", "write-failed" if the disk does not take the file
std::optional<ModelReport> write_model(Reconstructor& reconstructor,
                                       const SnapshotSource& snapshots,
                                       const std::filesystem::path& file,
                                       const std::stop_token& stop);

}  // namespace octurn
