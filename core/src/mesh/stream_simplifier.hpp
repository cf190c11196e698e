#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "mesh/aabb.hpp"
#include "mesh/indexed_mesh.hpp"
#include "mesh/mesh.hpp"
#include "mesh/qem_simplify.hpp"
#include "parallel/thread_team.hpp"

namespace octurn {

/// Simplifies a manifold mesh while it streams by from below, in bounded memory. It is closed, or
/// open where all vertices are `fixed`.
///
/// A window moves up through the mesh. In each window edges are collapsed (`qem_simplify`), and
/// what lies well below its upper end is emitted; the rest waits for the next window. Where a
/// collapse makes the surface intersect itself, the window is simplified again with the vertices
/// around there locked. So the result is closed, manifold and of the same genus as what was added;
/// and if that has no self-intersection, neither has the result.
///
/// Deterministic, for any number of threads. The result depends on the order of the pieces, and on
/// their sizes only through where windows end: not at all for a mesh of one window. Not
/// thread-safe.
class StreamSimplifier {
 public:
  /// @param target_error  millimetres, above 0: RMS distance of each vertex to the planes of the
  ///                      triangles that it stands for, weighted by area; no bound of the largest
  ///                      distance (see `qem_simplify`)
  /// @param margin        millimetres below the upper end of a window that wait for the next
  /// @param sink          takes the facets, from below, in spans that are valid during the call
  /// @param stop          looked at in each pass over a window: then `add` and `finish` throw
  ///                      `Stopped`
  /// @param team          the threads that share a window's work; must outlive this
  StreamSimplifier(double target_error, double margin, FacetSink sink, std::stop_token stop = {},
                   ThreadTeam& team = ThreadTeam::alone());

  /// Adds the next piece; z rises from piece to piece. Simplifies and emits when a window is full.
  void add(const MeshPiece& piece);

  /// Simplifies and emits the rest. Nothing may be added after.
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
