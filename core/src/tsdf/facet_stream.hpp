#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "mesh/mesh.hpp"
#include "octurn/stl.hpp"

namespace octurn {

/// Streams all triangles of a mesh as facets.
class FacetStream {
 public:
  explicit FacetStream(const FacetSink& sink) : sink_(sink) {}

  void add(const MeshPiece& piece) {
    // Triangles refer to vertices of this piece and of the one before.
    vertices_.erase(vertices_.begin(), vertices_.end() - static_cast<std::ptrdiff_t>(last_));
    first_ = next_ - static_cast<std::uint32_t>(last_);
    last_ = piece.vertices.size();
    next_ += static_cast<std::uint32_t>(last_);
    vertices_.insert(vertices_.end(), piece.vertices.begin(), piece.vertices.end());
    facets_.clear();
    for (const MeshTriangle& triangle : piece.triangles) {
      facets_.push_back(to_facet({vertices_[triangle[0] - first_], vertices_[triangle[1] - first_],
                                  vertices_[triangle[2] - first_]}));
    }
    sink_(facets_);
  }

 private:
  const FacetSink& sink_;
  std::vector<MeshVertex> vertices_ = {};
  std::vector<Facet> facets_ = {};
  std::size_t last_ = 0;  // vertices of the last piece
  std::uint32_t first_ = 0;
  std::uint32_t next_ = 0;
};

/// The facets of a surface that was counted, kept until the surface is drawn: all of them, or none
/// if they do not fit.
class KeptFacets {
 public:
  explicit KeptFacets(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Adds a piece; drops everything if it does not fit.
  void add(std::span<const Facet> facets);

  bool is_whole() const { return is_whole_; }

  /// Passes on the pieces that were added. @throws Stopped  between two of them
  void stream(const FacetSink& sink, const std::stop_token& stop) const;

 private:
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  bool is_whole_ = true;
  std::vector<std::vector<Facet>> pieces_ = {};
};

}  // namespace octurn
