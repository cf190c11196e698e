#include "mesh/mesh.hpp"

#include <cmath>

#include "mesh/vector3.hpp"

namespace octurn {

Facet to_facet(const std::array<MeshVertex, 3>& corners) {
  const auto& [a, b, c] = corners;
  Facet facet{.normal = {}, .corners = {a.position, b.position, c.position}, .attributes = 0};
  const Vector3 normal =
      area_normal(to_vector3(a.position), to_vector3(b.position), to_vector3(c.position));
  const double length = std::sqrt(dot(normal, normal));
  if (length > 0) {
    facet.normal = {static_cast<float>(normal[0] / length), static_cast<float>(normal[1] / length),
                    static_cast<float>(normal[2] / length)};
  }
  const int observed = int{a.observed} + int{b.observed} + int{c.observed};
  facet.attributes = observed >= 2 ? 0 : filled_in;
  return facet;
}

}  // namespace octurn
