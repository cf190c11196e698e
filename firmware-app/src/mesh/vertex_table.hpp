#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/facet_file.hpp"

namespace octurn {

using Vertex = std::array<float, 3>;  ///< millimetres, Z up

/// The corners of a mesh, each once, in the order in which its facets have them first: corners are
/// the same where their bits are, as an STL of this program has neighbours' corners. About 24 bytes
/// a vertex, so 12 a triangle.
class VertexTable {
 public:
  /// @throws Error "memory-limit"  if the mesh has more than 40 million triangles
  explicit VertexTable(const FacetFile& facets);

  std::span<const Vertex> vertices() const { return vertices_; }

  /// @param vertex  that a facet has
  std::uint32_t index(const Vertex& vertex) const;

 private:
  std::size_t find_slot(const Vertex& vertex) const;
  void insert(const Vertex& vertex);
  void grow();

  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> slots_;  // a hash table with linear probing; `empty` where it is free
};

}  // namespace octurn
