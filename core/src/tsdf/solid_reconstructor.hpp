#pragma once

#include <atomic>
#include <optional>
#include <stop_token>
#include <vector>

#include "depth/condition_depth.hpp"
#include "octurn/reconstruct.hpp"
#include "parallel/thread_team.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/facet_stream.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/standing_parts.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// Reconstruction of one closed solid by a truncated signed distance function.
///
/// Each snapshot is conditioned (`ConditionedDepth`; strips of lines: `strip_views`) and integrated
/// (`integrate`) into a `TsdfVolume`, in the order of the scan; `CompactTsdf` keeps each voxel's
/// distance and state. Then holes are filled (`HoleFilledSdf`), the components that stand on the
/// platform are kept (`standing_parts`) without spurs and cavities (`VoxelMask`), marching cubes
/// draw their surface (`marching_cubes`) and edges are collapsed (`StreamSimplifier`), all of it
/// streamed.
///
/// If the volume does not fit in the memory limit, it holds a slab, and the snapshots are read
/// again for each further slab. Slabs and threads change no byte of the surface.
///
/// With several poses of the object each snapshot is conditioned by its pose's clip box and
/// platform, the largest component is kept, and the base is flat only where it was not observed.
///
/// Facets that fill holes have the attribute `filled_in`. `Reconstructor` documents the members;
/// `count` makes the surface, and keeps it for `surface` if the memory limit allows.
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
  void fill_slab(const CompactTsdf& known, int low, const SnapshotSource& snapshots,
                 const std::stop_token& stop);
  void integrate_all(const SnapshotSource& snapshots, const std::stop_token& stop);
  int min_votes() const;
  CompactTsdf integrate_slabs(const SnapshotSource& snapshots, const std::stop_token& stop);
  int base_layer() const;
  std::vector<ConditionedDepth> condition(const Snapshot& snapshot);
  std::optional<double> max_bulge() const;
  HoleFilledSdf fill_holes(const CompactTsdf& known, const std::stop_token& stop,
                           ThreadTeam& team) const;
  StandingParts keep_parts(const HoleFilledSdf& sdf, const std::stop_token& stop,
                           ThreadTeam& team) const;
  SurfaceCount make_surface(const CompactTsdf& known, const HoleFilledSdf& sdf,
                            const FacetSink& sink, const std::stop_token& stop,
                            ThreadTeam& team) const;
  template <typename Field>
  void draw(const VoxelMask& solid, const Field& field, double target_error, const FacetSink& sink,
            const std::stop_token& stop, ThreadTeam& team) const;
  template <typename Field>
  std::uint64_t draw_limited(const VoxelMask& solid, const Field& field, const FacetSink& sink,
                             const std::stop_token& stop, ThreadTeam& team) const;

  ReconstructOptions options_;
  TsdfVolume volume_;
  std::size_t added_ = 0;                 // snapshots
  std::atomic<bool> sees_lines_ = false;  // whether a snapshot has strips of laser lines

  struct Counted {
    SurfaceCount count = {};
    KeptFacets facets;
  };
  std::optional<Counted> counted_ = {};  // since the last snapshot was added
};

}  // namespace octurn
