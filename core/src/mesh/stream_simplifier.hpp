#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "mesh/indexed_mesh.hpp"
#include "mesh/mesh.hpp"
#include "mesh/qem_simplify.hpp"
#include "mesh/vector3.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Simplifies a manifold mesh that is streamed from below, in bounded memory. The mesh is closed,
/// except for borders whose vertices are all `fixed`.
///
/// A window moves up through the mesh. In each window edges are collapsed (`qem_simplify`), and
/// triangles well below its upper end are emitted; the rest stays for the next window. If a
/// collapse makes the surface intersect itself, the window is simplified again with the vertices
/// around that place locked. The result is closed, manifold and of the same genus as the input; it
/// has no self-intersection if the input has none.
///
/// Deterministic for any number of threads. The result depends on the order of the pieces, and on
/// their sizes only through the ends of the windows. Not thread-safe.
class StreamSimplifier {
 public:
  /// @param target_error  millimetres, above 0: limit of each vertex's RMS distance, weighted by
  ///                      area, from the planes of the triangles that it replaces (see
  ///                      `qem_simplify`)
  /// @param margin        millimetres below the upper end of a window that stay for the next
  /// @param sink          receives the facets, from below
  /// @param stop          checked in each pass over a window: then `add` and `finish` throw
  ///                      `Stopped`
  /// @param team          the threads that share a window's work; must outlive this
  StreamSimplifier(double target_error, double margin, FacetSink sink, std::stop_token stop = {},
                   ThreadTeam& team = ThreadTeam::alone());

  /// Adds the next piece; z rises from piece to piece. Simplifies and emits when a window is full.
  void add(const MeshPiece& piece);

  /// Simplifies and emits the rest. No piece may be added afterwards.
  void finish();

 private:
  IndexedMesh with_all_quadrics() const;
  void simplify();
  bool lock_near(const std::vector<Aabb>& boxes, float reach);
  void flush_below(float end);
  void emit(std::span<const MeshTriangle> triangles);
  void compact_window();

  CollapseLimits limits_;
  double margin_;
  FacetSink sink_;
  std::stop_token stop_;
  ThreadTeam& team_;
  IndexedMesh mesh_ = {};          // with quadrics of the vertices that were in the last window
  std::vector<char> locked_ = {};  // vertices: emitted, on the open border, or near an intersection
  std::size_t flushed_ = 0;  // leading triangles already emitted; kept only as obstacles for the
                             // self-intersection test
  std::size_t added_ = 0;    // triangles since the last window
  std::uint32_t first_piece_ = 0;           // number of the first vertex of the last but one piece
  std::uint32_t last_piece_ = 0;            // and of the last
  std::vector<std::uint32_t> window_ = {};  // where the vertices of both are in the mesh
};

}  // namespace octurn
