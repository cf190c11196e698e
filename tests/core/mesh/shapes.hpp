#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/stream_simplifier.hpp"

namespace octurn {

/// A closed mesh that can be streamed: its vertices lie in layers, and each triangle joins vertices
/// of one layer or of two successive ones.
struct LayeredMesh {
  std::vector<MeshVertex> vertices = {};
  std::vector<MeshTriangle> triangles = {};
  std::vector<std::uint32_t> layers = {};  ///< index of each layer's first vertex
};

/// A sphere around (0, 0, `radius`), millimetres, with `2 * rings` vertices a ring.
inline LayeredMesh sphere(double radius, std::uint32_t rings) {
  const std::uint32_t around = 2 * rings;
  LayeredMesh mesh{.vertices = {{.position = {0, 0, 0}}}, .triangles = {}, .layers = {0}};
  for (std::uint32_t ring = 1; ring < rings; ++ring) {
    mesh.layers.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    const double tilt = std::numbers::pi * ring / rings;
    for (std::uint32_t i = 0; i < around; ++i) {
      const double turn = 2 * std::numbers::pi * i / around;
      mesh.vertices.push_back(
          {.position = {static_cast<float>(radius * std::sin(tilt) * std::cos(turn)),
                        static_cast<float>(radius * std::sin(tilt) * std::sin(turn)),
                        static_cast<float>(radius * (1 - std::cos(tilt)))}});
    }
  }
  mesh.layers.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
  mesh.vertices.push_back({.position = {0, 0, static_cast<float>(2 * radius)}});
  const auto at = [&](std::uint32_t ring, std::uint32_t i) {
    return ring == 0 || ring == rings ? mesh.layers[ring] : mesh.layers[ring] + i % around;
  };
  for (std::uint32_t ring = 0; ring < rings; ++ring) {
    for (std::uint32_t i = 0; i < around; ++i) {
      if (ring > 0) {
        mesh.triangles.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i)});
      }
      if (ring + 1 < rings) {
        mesh.triangles.push_back({at(ring, i + 1), at(ring + 1, i + 1), at(ring + 1, i)});
      }
    }
  }
  return mesh;
}

/// Feeds a mesh to a simplifier in pieces of `layers_per_piece` layers.
inline void stream(const LayeredMesh& mesh, std::size_t layers_per_piece,
                   StreamSimplifier& simplifier) {
  auto triangle = mesh.triangles.begin();
  for (std::size_t layer = 0; layer < mesh.layers.size(); layer += layers_per_piece) {
    const std::size_t next = layer + layers_per_piece;
    const std::size_t end = next < mesh.layers.size() ? mesh.layers[next] : mesh.vertices.size();
    const auto last = std::find_if(triangle, mesh.triangles.end(), [&](const MeshTriangle& t) {
      return std::max({t[0], t[1], t[2]}) >= end;
    });
    simplifier.add(
        {.vertices = std::span(mesh.vertices).subspan(mesh.layers[layer], end - mesh.layers[layer]),
         .triangles = {triangle, last}});
    triangle = last;
  }
  simplifier.finish();
}

/// Simplifies a mesh that is streamed in pieces of `layers_per_piece` layers.
inline std::vector<Facet> simplified(const LayeredMesh& mesh, double target_error,
                                     std::size_t layers_per_piece) {
  std::vector<Facet> facets;
  StreamSimplifier simplifier(target_error, 4, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  stream(mesh, layers_per_piece, simplifier);
  return facets;
}

}  // namespace octurn
