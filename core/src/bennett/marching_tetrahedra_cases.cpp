#include "bennett/marching_tetrahedra_cases.hpp"

#include <cmath>

namespace octurn {
namespace {

using Corner = int;  // bit 0: x, bit 1: y, bit 2: z

constexpr std::array<std::array<Corner, 4>, 6> tetrahedra{
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

HalfSteps middle(Corner a, Corner b) {
  HalfSteps steps{};
  for (int axis = 0; axis < 3; ++axis) {
    steps[static_cast<std::size_t>(axis)] =
        static_cast<std::int8_t>((a >> axis & 1) + (b >> axis & 1));
  }
  return steps;
}

/// Adds a facet, turned so that the corner `inside` lies behind it.
void add_facet(TetrahedraCase& surface, HalfSteps a, HalfSteps b, HalfSteps c, Corner inside) {
  std::array<int, 3> ab{};
  std::array<int, 3> ac{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ab[axis] = b[axis] - a[axis];
    ac[axis] = c[axis] - a[axis];
  }
  std::array<int, 3> normal{ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                            ab[0] * ac[1] - ab[1] * ac[0]};
  const HalfSteps from = middle(inside, inside);
  int ahead = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    ahead += normal[axis] * (a[axis] - from[axis]);
  }
  const int sign = ahead < 0 ? -1 : 1;
  const int square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  CaseFacet& facet = surface.facets[surface.count++];
  facet.corners = sign < 0 ? std::array{a, c, b} : std::array{a, b, c};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    facet.normal[axis] =
        static_cast<float>(sign * normal[axis]) / std::sqrt(static_cast<float>(square));
  }
}

void add_tetrahedron(TetrahedraCase& surface, const std::array<Corner, 4>& tetrahedron,
                     int pattern) {
  std::array<Corner, 4> in{};
  std::array<Corner, 4> out{};
  std::size_t ins = 0;
  std::size_t outs = 0;
  for (const Corner corner : tetrahedron) {
    (pattern >> corner & 1 ? in[ins++] : out[outs++]) = corner;
  }
  if (ins == 1) {
    add_facet(surface, middle(in[0], out[0]), middle(in[0], out[1]), middle(in[0], out[2]), in[0]);
    --surface.excess;
  } else if (ins == 2) {
    const HalfSteps a = middle(in[0], out[0]);
    const HalfSteps c = middle(in[1], out[1]);
    add_facet(surface, a, middle(in[0], out[1]), c, in[0]);
    add_facet(surface, a, c, middle(in[1], out[0]), in[1]);
  } else if (ins == 3) {
    add_facet(surface, middle(in[0], out[0]), middle(in[1], out[0]), middle(in[2], out[0]), in[0]);
    ++surface.excess;
  }
}

std::array<TetrahedraCase, 256> all_patterns() {
  std::array<TetrahedraCase, 256> surfaces{};
  for (int pattern = 0; pattern < 256; ++pattern) {
    for (const std::array<Corner, 4>& tetrahedron : tetrahedra) {
      add_tetrahedron(surfaces[static_cast<std::size_t>(pattern)], tetrahedron, pattern);
    }
  }
  return surfaces;
}

}  // namespace

const std::array<TetrahedraCase, 256> marching_tetrahedra_cases = all_patterns();

}  // namespace octurn
