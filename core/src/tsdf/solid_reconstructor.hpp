#pragma once

#include <stop_token>

#include "octurn/reconstruct.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// A model in the making by signed distances: snapshots are fused, then one closed part is made of
/// them.
///
/// Each snapshot is conditioned (`ConditionedDepth`) and fused (`fuse`) in a field of distances, in
/// the order of the scan, and what that says of each leaf is kept (`CompactTsdf`). Then what nobody
/// saw is filled in (`HoleFilledSdf`), the part that stands on the platform is kept without its
/// cavities
/// (`VoxelMask`), and its surface is made
/// (`marching_cubes`) with no more triangles than it needs (`StreamSimplifier`), all of it
/// streamed.
///
/// Where the field does not fit in the memory limit, it holds as many of its lowest layers as do: a
/// slab. For the others the snapshots are read again. Neither slabs nor threads change a byte of
/// the surface.
///
/// A facet's attributes are `filled_in` where nobody saw the surface. What the members do, and
/// throw, `Reconstruction` says; `count` is as much work as `surface`.
class SolidReconstructor final : public Reconstructor {
 public:
  explicit SolidReconstructor(const ReconstructOptions& options);
  void add(const Snapshot& snapshot, const std::stop_token& stop = {}) override;
  void add(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;
  SurfaceCount surface(const SnapshotSource& snapshots, const FacetSink& sink,
                       const std::stop_token& stop = {}) override;
  SurfaceCount count(const SnapshotSource& snapshots, const std::stop_token& stop = {}) override;
  void preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
               const std::stop_token& stop = {}) const override;

 private:
  CompactTsdf seen(const SnapshotSource& snapshots, const std::stop_token& stop);
  int foot() const;

  ReconstructOptions options_;
  TsdfVolume field_;
};

}  // namespace octurn
