#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace octurn {

/// A corner of a facet inside a pseudo-voxel, in halves of its side: 0, 1 or 2 on each axis.
using HalfSteps = std::array<std::int8_t, 3>;

struct CaseFacet {
  std::array<HalfSteps, 3> corners = {};
  std::array<float, 3> normal = {};  // of length one, outward
};

/// The facets of a pseudo-voxel by the pattern of its corners: bit x + 2y + 4z is set where the
/// corner (x, y, z) is inside.
struct TetrahedraCase {
  static constexpr std::size_t max_facets = 12;  // two in each of six tetrahedra
  std::array<CaseFacet, max_facets> facets = {};
  std::size_t count = 0;
  /// The volume inside, beyond n/4 of each tetrahedron with n of its corners inside, in eighths of
  /// a tetrahedron: tetrahedra cut in the middles of their edges hold 0, 1/8, 1/2, 7/8 and 1.
  int excess = 0;
};

/// Marching Tetrahedra for all 256 patterns, on the six tetrahedra that share the diagonal from
/// corner 0 to corner 7.
extern const std::array<TetrahedraCase, 256> marching_tetrahedra_cases;

}  // namespace octurn
