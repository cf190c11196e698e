#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/quadric.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// A triangle mesh with shared vertices, and for each the quadric of the original surface, which
/// edge collapse needs.
struct IndexedMesh {
  std::vector<MeshVertex> vertices = {};
  std::vector<Quadric> quadrics = {};  ///< one per vertex; apart, so that positions stay in cache
  std::vector<MeshTriangle> triangles = {};
};

/// Adds to each vertex's quadric the planes of its triangles, from the triangle `first` on, in
/// their order. The last vertices may be without a quadric yet.
void add_plane_quadrics(IndexedMesh& mesh, std::size_t first,
                        ThreadTeam& team = ThreadTeam::alone());

constexpr std::uint32_t removed_vertex = std::numeric_limits<std::uint32_t>::max();

/// Removes the vertices that neither a triangle nor `also_used` refers to; the others keep their
/// order. O(vertices + triangles).
///
/// @returns for each old vertex its new index, or `removed_vertex`
std::vector<std::uint32_t> compact(IndexedMesh& mesh, std::span<const std::uint32_t> also_used);

}  // namespace octurn
