#pragma once

#include <stop_token>

#include "octurn/distance_field.hpp"
#include "octurn/isosurface.hpp"
#include "octurn/leaf_set.hpp"
#include "octurn/reconstruct_options.hpp"
#include "octurn/seen_field.hpp"

namespace octurn {

/// A model in the making by signed distances: snapshots are fused, then one closed part is made of
/// them.
///
/// Each snapshot is conditioned (`Sighting`) and fused (`fuse`) in a field of distances, in the
/// order of the scan, and what that says of each leaf is kept (`SeenField`). Then what nobody saw
/// is filled in (`FilledField`), the part that stands on the platform is kept without its cavities
/// (`LeafSet`), and its surface is made
/// (`marching_cubes`) with no more triangles than it needs (`Simplifier`), all of it streamed.
///
/// Where the field does not fit in the memory limit, it holds as many of its lowest layers as do: a
/// slab. For the others the snapshots are read again. Neither slabs nor threads change a byte of
/// the surface.
///
/// A facet's attributes are `filled_in` where nobody saw the surface. What the members do, and
/// throw, `Reconstruction` says; `count` is as much work as `surface`.
class Solid {
 public:
  explicit Solid(const ReconstructOptions& options);
  void add(const Snapshot& snapshot);
  void add(const SnapshotSource& snapshots, const std::stop_token& stop = {});
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink);
  SurfaceCount count(const SnapshotSource& snapshots);
  void preview(double leaf_size, std::uint64_t most_facets, const FacetSink& sink) const;

 private:
  SeenField seen(const SnapshotSource& snapshots);
  int foot() const;

  ReconstructOptions options_;
  DistanceField field_;
};

}  // namespace octurn
