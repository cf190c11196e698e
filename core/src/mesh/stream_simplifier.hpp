#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <stop_token>
#include <vector>

#include "mesh/mesh.hpp"
#include "mesh/triangle_adjacency.hpp"

namespace octurn {

/// Makes a mesh of fewer triangles while it streams by from below, in bounded memory.
///
/// Edges are collapsed where the surface stays within an error of the planes that it came from
/// (Garland and Heckbert 1997), the cheapest first, if the mesh stays manifold (the link condition,
/// Dey et al. 1999), no triangle turns over, and the surface does not come to cut itself. That is
/// done in a window that moves up: what lies well below its upper end is handed on, the rest waits
/// for what comes.
class StreamSimplifier {
 public:
  /// @param target_error  millimetres, above 0
  /// @param margin     millimetres below the upper end of a window that wait for the next
  /// @param stop       looked at in each pass over a window: then `add` and `finish` throw
  /// `Stopped`
  StreamSimplifier(double target_error, double margin, FacetSink sink, std::stop_token stop = {});

  void add(const MeshPiece& piece);

  /// Hands on the rest.
  void finish();

 private:
  /// The sum of squared distances to planes, weighted by area, as a symmetric matrix.
  struct Quadric {
    std::array<double, 10> terms = {};
    double area = 0;

    void operator+=(const Quadric& other) {
      for (std::size_t i = 0; i < terms.size(); ++i) {
        terms[i] += other.terms[i];
      }
      area += other.area;
    }
  };

  struct Vertex {
    std::array<float, 3> position = {};
    bool seen = false;
    bool fixed = false;  // the surface around it is not all here
  };

  struct Collapse {
    double cost = 0;
    std::uint32_t kept = 0;
    std::uint32_t gone = 0;
    std::array<float, 3> position = {};
  };

  void add_quadrics(std::size_t first_triangle);
  void simplify();
  void collapse_edges();
  void list_collapses(double limit, double refused);
  void sort_collapses();
  Collapse collapse_of(std::uint32_t a, std::uint32_t b) const;
  void prefetch(const Collapse& collapse) const;
  bool may_collapse(const Collapse& collapse) const;
  bool are_neighbours(std::uint32_t a, std::uint32_t b) const;
  bool flips_or_degenerates(const Collapse& collapse, std::uint32_t around,
                            std::uint32_t other) const;
  void apply(const Collapse& collapse);
  void drop_collapsed();
  void flush_below(float end);

  double target_error_;
  double margin_;
  FacetSink sink_;
  std::stop_token stop_;
  std::vector<Vertex> vertices_ = {};
  std::vector<Quadric> quadrics_ = {};  // of the vertices; apart, so that those stay in the cache
  std::vector<MeshTriangle> triangles_ = {};
  std::size_t flushed_ = 0;                              // of them; they are only in the way
  float bottom_ = std::numeric_limits<float>::lowest();  // of what the others may become
  float top_ = std::numeric_limits<float>::max();
  std::size_t fresh_ = 0;                  // triangles since the last pass
  std::uint32_t first_name_ = 0;           // of the vertices of the last two pieces
  std::vector<std::uint32_t> names_ = {};  // where those are in the window
  std::uint32_t last_piece_ = 0;           // name of its first vertex
  TriangleAdjacency corners_ = {};
  std::vector<Collapse> collapses_ = {};
  std::vector<char> touched_ = {};  // vertices, in this pass
  std::vector<char> changed_ = {};  // vertices, or triangles at them, in this pass
  std::vector<Facet> facets_ = {};
};

}  // namespace octurn
