#pragma once

#include <stop_token>

#include "octurn/reconstruct.hpp"
#include "voxel/octree.hpp"

namespace octurn {

/// Voxel octree intersection (Bennett 2014): world_points -> clip -> triangulate -> snap ->
/// voxelize_triangle, then marching_tetrahedra.
///
/// If the octree exceeds the memory limit, it holds a slab: as many of its lowest layers as fit.
/// The surface is then made slab by slab, and the snapshots are read again for each. Slabs and
/// threads change no byte of the surface. `Reconstructor` documents the members; `count` is quick
/// if there is one slab.
class BennettReconstructor final : public Reconstructor {
 public:
  explicit BennettReconstructor(const ReconstructOptions& options);
  void add(const Snapshot& snapshot, const std::stop_token& stop = {}) override;
  void add(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink,
                       const std::stop_token& stop = {}) override;
  ModelReport measured_surface(const SnapshotSource& snapshots, const FacetSink& sink,
                               const std::stop_token& stop = {}) override;
  SurfaceCount count(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;
  void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
               const std::stop_token& stop = {}) const override;

 private:
  void voxelize(const Snapshot& snapshot, Octree& octree, BrickLayers& slab) const;
  template <typename Fill>
  void within_budget(Octree& octree, BrickLayers& slab, Fill fill) const;
  void shrink_slab(Octree& octree, BrickLayers& slab) const;
  void merge(Octree& other);
  void begin_slab(const BrickLayers& slab, const SnapshotSource& snapshots,
                  const std::stop_token& stop);
  void draw(const BrickLayers& slab, const FacetSink& sink, const std::stop_token& stop,
            SurfaceCount& count) const;
  template <typename Visit>
  void for_each_slab(const SnapshotSource& snapshots, const std::stop_token& stop, Visit visit);

  ReconstructOptions options_;
  int wanted_threads_;  // before the memory limit reduced the options' number
  Octree octree_;
  BrickLayers slab_ = {};  // in the octree, with the lowest leaves of the next layer
};

}  // namespace octurn
