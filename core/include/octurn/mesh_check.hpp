#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "octurn/box.hpp"
#include "octurn/facet.hpp"

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

  /// The share of the surface's area in facets that are marked as filled in.
  double filled_share() const { return area_ > 0 ? filled_area_ / area_ : 0; }

  /// The box around all corners, millimetres.
  const Box& bounds_mm() const { return bounds_mm_; }

 private:
  std::uint64_t facets_ = 0;
  std::uint64_t edges_ = 0;
  double six_volumes_ = 0;
  double area_ = 0;  // both areas twice, mm2
  double filled_area_ = 0;
  Box bounds_mm_ = {};
};

}  // namespace octurn
