#pragma once

#include <stop_token>

#include "octurn/isosurface.hpp"
#include "octurn/octree.hpp"
#include "octurn/reconstruct_options.hpp"

namespace octurn {

/// A model in the making by voxel octree intersection: snapshots are added, then its surface is
/// asked for.
///
/// Where the octree does not fit in the memory limit, it keeps as many of its lowest layers as do:
/// a slab. The surface is then made slab by slab, and for each the snapshots are read again.
/// Neither slabs nor threads change a byte of it.
class Intersection {
 public:
  /// @throws Error "bad-settings"  that says which option is out of its range
  /// @throws Error "memory-limit"  that says what limit would do
  explicit Intersection(const ReconstructOptions& options);

  /// Depth -> world points -> clip -> triangles -> octree.
  /// @throws Error "memory-limit"  if not even the smallest slab fits
  void add(const Snapshot& snapshot);

  /// The same for all of them, on as many threads as the options say. Ends early if stopped.
  void add(const SnapshotSource& snapshots, const std::stop_token& stop = {});

  /// Octree -> isosurface, streamed. What `sink` throws ends it.
  /// @param snapshots  those that were added, to be read again if there are several slabs
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink);

  /// What `surface` would give, without making it: a moment's work if there is one slab.
  SurfaceCount count(const SnapshotSource& snapshots);

  /// The surface of what was seen so far, on the first level whose nodes are at or below
  /// `leaf_size` (metres), or on the finest above it that has no more than `most_facets`.
  /// Of several slabs it shows the one at hand.
  void preview(double leaf_size, std::uint64_t most_facets, const FacetSink& sink) const;

 private:
  void see(const Snapshot& snapshot, Octree& octree, BrickLayers& slab) const;
  void keep_what_fits(Octree& octree, BrickLayers& slab) const;
  void merge(Octree& other);
  void begin_slab(const BrickLayers& slab, const SnapshotSource& snapshots);
  template <typename Visit>
  void for_each_slab(const SnapshotSource& snapshots, Visit visit);

  ReconstructOptions options_;
  int wanted_threads_;  // of which the memory limit leaves as many as the options say
  Octree octree_;
  BrickLayers slab_ = {};  // the octree holds these, and the lowest leaves of the layer after them
};

}  // namespace octurn
