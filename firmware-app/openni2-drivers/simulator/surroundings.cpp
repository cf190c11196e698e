#include "simulator/surroundings.hpp"

#include <cmath>
#include <numbers>

namespace octurn {
namespace {

void add_platform(Mesh& mesh) {
  constexpr double radius = 0.150;
  constexpr float thickness = 0.0127F;
  constexpr std::uint32_t corners = 128;  // the polygon is within 0.05 mm of the circle
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    const auto x = static_cast<float>(radius * std::cos(angle));
    const auto y = static_cast<float>(radius * std::sin(angle));
    mesh.vertices.emplace_back(x, y, 0.0F);
    mesh.vertices.emplace_back(x, y, -thickness);
  }
  mesh.vertices.emplace_back(0.0F, 0.0F, 0.0F);
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t top = first + 2 * i;
    const std::uint32_t next_top = first + 2 * ((i + 1) % corners);
    mesh.triangles.push_back({first + 2 * corners, top, next_top});
    mesh.triangles.push_back({top, top + 1, next_top + 1});
    mesh.triangles.push_back({top, next_top + 1, next_top});
  }
}

}  // namespace

void add_rectangle(Mesh& mesh, const Eigen::Vector3f& corner, const Eigen::Vector3f& side,
                   const Eigen::Vector3f& other_side) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex :
       {corner, Eigen::Vector3f(corner + side), Eigen::Vector3f(corner + side + other_side),
        Eigen::Vector3f(corner + other_side)}) {
    mesh.vertices.push_back(vertex);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

Mesh surroundings() {
  Mesh mesh;
  add_platform(mesh);
  add_rectangle(mesh, {-1.0F, -0.45F, -0.08F}, {2.0F, 0, 0}, {0, 1.2F, 0});  // table
  add_rectangle(mesh, {-1.5F, 0.95F, -0.8F}, {3.0F, 0, 0}, {0, 0, 2.0F});    // wall
  return mesh;
}

}  // namespace octurn
