#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/mesh.hpp"

namespace octurn {

/// Consecutive pieces of a mesh, kept until they can be streamed in order. Vertex numbers begin
/// with the piece before them.
class MeshPieces {
 public:
  void add(const MeshPiece& piece) {
    vertices_.insert(vertices_.end(), piece.vertices.begin(), piece.vertices.end());
    triangles_.insert(triangles_.end(), piece.triangles.begin(), piece.triangles.end());
    ends_.push_back({vertices_.size(), triangles_.size()});
  }

  void clear() {
    vertices_.clear();
    triangles_.clear();
    ends_.clear();
  }

  std::size_t vertex_count() const { return vertices_.size(); }

  /// @param first  number, in the whole mesh, of the first vertex of the piece before these
  void stream(std::uint32_t first, const MeshSink& sink) {
    for (MeshTriangle& triangle : triangles_) {
      for (std::uint32_t& corner : triangle) {
        corner += first;
      }
    }
    End begin;
    for (const End& end : ends_) {
      sink({.vertices = std::span(vertices_).subspan(begin.vertices, end.vertices - begin.vertices),
            .triangles =
                std::span(triangles_).subspan(begin.triangles, end.triangles - begin.triangles)});
      begin = end;
    }
  }

 private:
  struct End {
    std::size_t vertices = 0;
    std::size_t triangles = 0;
  };
  std::vector<MeshVertex> vertices_ = {};
  std::vector<MeshTriangle> triangles_ = {};
  std::vector<End> ends_ = {};
};

}  // namespace octurn
