#pragma once

#include <stop_token>

#include "depth/condition_depth.hpp"
#include "octurn/reconstruct.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// Reconstruction of one closed solid by a truncated signed distance function.
///
/// Each snapshot is conditioned (`ConditionedDepth`) and integrated (`integrate`) into a
/// `TsdfVolume`, in the order of the scan; each voxel's distance and state are kept
/// (`CompactTsdf`). Then holes are filled (`HoleFilledSdf`), the main connected component is kept
/// without spurs and cavities (`VoxelMask`), marching cubes draw its surface (`marching_cubes`) and
/// edges are collapsed (`StreamSimplifier`), all of it streamed.
///
/// Where the volume does not fit in the memory limit it holds a slab, and the snapshots are read
/// again for each further one. Neither slabs nor threads change a byte of the surface.
///
/// Of an object in several poses each snapshot is conditioned by its pose's clip box and platform,
/// the largest component is kept, and its foot is flat only where nothing saw it.
///
/// Facets in holes have the attribute `filled_in`. The contract of the members is
/// `Reconstructor`'s; `count` takes as long as `surface`.
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
  CompactTsdf integrate_slabs(const SnapshotSource& snapshots, const std::stop_token& stop);
  void expect_room_for_masks(const CompactTsdf& known, const HoleFilledSdf& sdf) const;
  int base_layer() const;
  ConditionedDepth condition(const Snapshot& snapshot) const;
  HoleFilledSdf fill_holes(const CompactTsdf& known, const std::stop_token& stop) const;
  void draw(const VoxelMask& solid, const HoleFilledSdf& sdf, const FacetSink& sink,
            const std::stop_token& stop) const;

  ReconstructOptions options_;
  TsdfVolume volume_;
};

}  // namespace octurn
