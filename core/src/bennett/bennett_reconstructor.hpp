#pragma once

#include <stop_token>

#include "octurn/reconstruct.hpp"
#include "voxel/octree.hpp"

namespace octurn {

/// A model in the making by voxel octree intersection: snapshots are added, then its surface is
/// asked for.
///
/// Where the octree does not fit in the memory limit, it keeps as many of its lowest layers as do:
/// a slab. The surface is then made slab by slab, and for each the snapshots are read again.
/// Neither slabs nor threads change a byte of it.
///
/// What the members do, and throw, `Reconstruction` says; `count` is a moment's work if there is
/// one slab.
class BennettReconstructor final : public Reconstructor {
 public:
  explicit BennettReconstructor(const ReconstructOptions& options);
  void add(const Snapshot& snapshot, const std::stop_token& stop = {}) override;
  void add(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink,
                       const std::stop_token& stop = {}) override;
  SurfaceCount count(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;
  void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
               const std::stop_token& stop = {}) const override;

 private:
  void see(const Snapshot& snapshot, Octree& octree, BrickLayers& slab) const;
  void keep_what_fits(Octree& octree, BrickLayers& slab) const;
  void merge(Octree& other);
  void begin_slab(const BrickLayers& slab, const SnapshotSource& snapshots,
                  const std::stop_token& stop);
  template <typename Visit>
  void for_each_slab(const SnapshotSource& snapshots, const std::stop_token& stop, Visit visit);

  ReconstructOptions options_;
  int wanted_threads_;  // of which the memory limit leaves as many as the options say
  Octree octree_;
  BrickLayers slab_ = {};  // the octree holds these, and the lowest leaves of the layer after them
};

}  // namespace octurn
