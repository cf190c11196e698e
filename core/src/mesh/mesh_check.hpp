#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/places.hpp"
#include "mesh/surface_cells.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"

namespace octurn {

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

  /// The share of the surface's area in facets that hole filling made, 0 to 1.
  double filled_share() const { return area_ > 0 ? filled_area_ / area_ : 0; }

  /// The same without the base, the facets in z = 0.
  double unseen_share() const {
    return area_ > base_area_ ? (filled_area_ - filled_base_area_) / (area_ - base_area_) : 0;
  }

  /// Metres: where the surface above the base was made by hole filling.
  std::vector<Eigen::Vector3d> unseen_places() const { return unseen_places_.centres(); }

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

/// The figures of a surface whose facets were all added to `check`.
ModelReport make_report(const SurfaceCount& count, const MeshCheck& check);

}  // namespace octurn
