#include "mesh/mesh.hpp"

#include <cmath>

#include "mesh/vector3.hpp"

namespace octurn {

Facet to_facet(const std::array<MeshVertex, 3>& corners) {
  Facet facet;
  std::array<std::array<float, 3>, 3> positions{};
  int seen = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    positions[i] = corners[i].position;
    seen += corners[i].seen ? 1 : 0;
  }
  std::array<double, 3> ab{};
  std::array<double, 3> ac{};
  for (std::size_t i = 0; i < 3; ++i) {
    ab[i] = static_cast<double>(positions[1][i]) - static_cast<double>(positions[0][i]);
    ac[i] = static_cast<double>(positions[2][i]) - static_cast<double>(positions[0][i]);
  }
  const std::array normal{ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                          ab[0] * ac[1] - ab[1] * ac[0]};
  const double length =
      std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
  if (length > 0) {
    facet.normal = {static_cast<float>(normal[0] / length), static_cast<float>(normal[1] / length),
                    static_cast<float>(normal[2] / length)};
  }
  facet.corners = positions;
  facet.attributes = seen >= 2 ? 0 : filled_in;
  return facet;
}

}  // namespace octurn
