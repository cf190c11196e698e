#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "file_descriptor.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// A binary STL file whose facets can be read in order, in blocks, any number of times.
class FacetFile {
 public:
  /// @throws Error "no-model"  if there is no such file, it has no facets, or its size does not
  /// match
  ///                           their number
  explicit FacetFile(const std::filesystem::path& file);

  std::uint64_t count() const { return count_; }

  /// Passes all facets to the sink, in blocks. @throws Error "read-failed"
  void read(const FacetSink& sink) const;

 private:
  FileDescriptor file_;
  std::uint64_t count_ = 0;
};

using Vertex = std::array<float, 3>;  ///< millimetres, Z up

/// The distinct vertices of a mesh, in order of their first use by a facet. Corners are one vertex
/// if their bits are equal, as those of neighbouring facets are in an STL of this program. Takes
/// at most 54 MB, so that a request that colours them, too, takes less than 100.
class VertexTable {
 public:
  /// @throws Error "memory-limit"  if the mesh has more than 2.3 million vertices, so 4.6 million
  ///                               triangles of a closed one
  explicit VertexTable(const FacetFile& facets);

  std::span<const Vertex> vertices() const { return vertices_; }

  /// The index of a vertex. @param vertex  a corner of one of the facets
  std::uint32_t index(const Vertex& vertex) const;

 private:
  std::size_t find_slot(const Vertex& vertex) const;
  void insert(const Vertex& vertex);
  void grow();

  std::vector<Vertex> vertices_;
  std::vector<std::uint32_t> slots_;  // hash table of indices, linear probing; `empty`: free
};

}  // namespace octurn
