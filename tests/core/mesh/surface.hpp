#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <vector>

#include "octurn/stl.hpp"
#include "tsdf/marching_cubes.hpp"

namespace octurn {

/// All facets of the isosurface around a set of voxels.
inline std::vector<Facet> surface_of(const VoxelMask& set, const HoleFilledSdf& filled) {
  std::vector<MeshVertex> vertices;
  std::vector<Facet> facets;
  marching_cubes(set, filled, [&](const MeshPiece& piece) {
    vertices.insert(vertices.end(), piece.vertices.begin(), piece.vertices.end());
    for (const MeshTriangle& t : piece.triangles) {
      facets.push_back(to_facet({vertices[t[0]], vertices[t[1]], vertices[t[2]]}));
    }
  });
  return facets;
}

inline bool same_bytes(const std::vector<Facet>& a, const std::vector<Facet>& b) {
  return std::ranges::equal(std::as_bytes(std::span(a)), std::as_bytes(std::span(b)));
}

/// The topology of a surface as a slicer sees it, counted by the simplest method.
struct Topology {
  bool closed = true;    ///< each directed edge is there once, and its opposite once
  bool manifold = true;  ///< the facets at each vertex form one fan
  int euler = 0;         ///< vertices - edges + facets
};

inline Topology topology_of(std::span<const Facet> facets) {
  using Vertex = std::array<float, 3>;
  std::map<Vertex, int> vertices;
  std::map<std::pair<int, int>, int> next;  // directed edge (a, b) -> third corner
  Topology topology;
  std::map<int, std::map<int, int>> fans;  // vertex -> corner before -> corner after
  for (const Facet& facet : facets) {
    std::array<int, 3> corners{};
    const auto points = facet.corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = vertices.try_emplace(points[i], static_cast<int>(vertices.size())).first->second;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const int a = corners[i];
      const int b = corners[(i + 1) % 3];
      topology.closed =
          topology.closed && a != b && next.try_emplace({a, b}, corners[(i + 2) % 3]).second;
      fans[a][b] = corners[(i + 2) % 3];
    }
  }
  for (const auto& [edge, third] : next) {
    topology.closed = topology.closed && next.contains({edge.second, edge.first});
  }
  for (const auto& [vertex, fan] : fans) {
    std::size_t walked = 0;
    int at = fan.begin()->first;
    do {
      const auto found = fan.find(at);
      if (found == fan.end()) {
        break;
      }
      at = found->second;
      ++walked;
    } while (at != fan.begin()->first && walked <= fan.size());
    topology.manifold = topology.manifold && walked == fan.size();
  }
  topology.manifold = topology.manifold && topology.closed;
  topology.euler = static_cast<int>(vertices.size()) - static_cast<int>(next.size() / 2) +
                   static_cast<int>(facets.size());
  return topology;
}

}  // namespace octurn
