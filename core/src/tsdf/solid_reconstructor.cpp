#include "tsdf/solid_reconstructor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "depth/condition_depth.hpp"
#include "depth/crop.hpp"
#include "depth/find_placement.hpp"
#include "laser/strip_views.hpp"
#include "mesh/stream_simplifier.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "parallel/thread_team.hpp"
#include "tsdf/edited_sdf.hpp"
#include "tsdf/facet_stream.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/marching_cubes.hpp"
#include "tsdf/memory_plan.hpp"
#include "tsdf/observed_surface.hpp"
#include "tsdf/voxel_grid.hpp"
#include "voxel/connected_components.hpp"
#include "voxel/memory_limit.hpp"

namespace octurn {
namespace {

// With fewer snapshots, one snapshot's rays are enough for free space: hardly another sees the
// same.
constexpr std::size_t few_snapshots = 4;

// With several poses three snapshots have to agree on free space: a wrong ray would open the
// inside, and no other pose would close it.
constexpr int min_votes_of_poses = 2 * votes_of_surface_ray + votes_of_any_ray;

// The lowest layers of the clip box hold some of the platform's noise: the base layer is the first
// one this far above the box's bottom.
constexpr double base_margin = 0.001;  // metres

// Maximum distance of fill from the convex hull of what was seen by laser line.
constexpr double max_bulge_of_lines = 0.005;  // metres

/// The simplifier's margin below the upper end of its window.
constexpr double margin_voxels = 8;

// The search for a number of triangles: draws after the first that has few enough, and the largest
// error, in voxels.
constexpr int refining_draws = 4;
constexpr double max_error_voxels = 2;

/// How often voxels can be merged, eight to one, before their side exceeds `leaf_size`.
int halvings_to(double leaf_size, const VoxelGrid& grid) {
  int halvings = 0;
  while (halvings < grid.levels() && grid.voxel_side() * (2 << halvings) <= leaf_size) {
    ++halvings;
  }
  return halvings;
}

/// The smallest error that leaves few enough triangles, found by doubling and bisection; `max` if
/// none does.
template <typename IsTooMany>
double min_error(double first, double max, const IsTooMany& is_too_many) {
  if (!is_too_many(first)) {
    return first;
  }
  constexpr double least = 1e-5;  // metres
  double low = std::max(first, least);
  double high = std::min(2 * low, max);
  while (high < max && is_too_many(high)) {
    low = high;
    high = std::min(2 * high, max);
  }
  for (int i = 0; i < refining_draws && low < high; ++i) {
    const double middle = std::sqrt(low * high);
    (is_too_many(middle) ? low : high) = middle;
  }
  return high;
}

/// Removes the voxels that are cut off or erased, and then crumbs and spurs.
void remove_edited(VoxelMask& mask, const EditedSdf& sdf, std::uint64_t min_part,
                   const std::stop_token& stop, ThreadTeam& team) {
  const Index3 low = mask.low();
  team.for_each(mask.size().z, [&](int z) {
    throw_if_stopped(stop);
    for (int y = 0; y < mask.size().y; ++y) {
      for (int x = 0; x < mask.size().x; ++x) {
        if (mask.contains(x, y, z) && sdf.is_removed({low.x + x, low.y + y, low.z + z})) {
          assign(mask.row(y, z), x, x + 1, false);
        }
      }
    }
  });
  keep_standing_components(mask, mask.size().z, min_part, stop);
  mask.remove_spurs(stop);
}

}  // namespace

SolidReconstructor::SolidReconstructor(const ReconstructOptions& options)
    : options_(checked_solid_options(options)),
      volume_(make_solid_grid(options_),
              slab_budget(options_, CompactTsdf(make_solid_grid(options_)))) {}

void SolidReconstructor::add(const Snapshot& snapshot, const std::stop_token& stop) try {
  throw_if_stopped(stop);
  counted_.reset();
  for (const ConditionedDepth& depth : condition(snapshot)) {
    integrate(volume_, depth, stop);
  }
  ++added_;
} catch (const OutOfBudget&) {
  throw_memory_limit(options_);
}

void SolidReconstructor::add(const SnapshotSource& snapshots, const std::stop_token& stop) try {
  counted_.reset();
  if (added_ == 0) {
    fill_slab(CompactTsdf(volume_.grid()), 0, snapshots, stop);
  } else {
    integrate_all(snapshots, stop);
  }
  added_ += snapshots.count;
} catch (const OutOfBudget&) {
  throw_memory_limit(options_);
}

/// Integrates all snapshots into the slab from a layer on, with fewer threads if their memory
/// leaves too little for the slab.
/// @param known  the slabs below
void SolidReconstructor::fill_slab(const CompactTsdf& known, int low,
                                   const SnapshotSource& snapshots, const std::stop_token& stop) {
  for (;; --options_.threads) {
    try {
      volume_.reset_to_slab(low, slab_budget(options_, known));
      integrate_all(snapshots, stop);
      return;
    } catch (const OutOfBudget&) {
      if (options_.threads == 1) {
        throw_memory_limit(options_);
      }
    }
  }
}

/// @throws OutOfBudget
void SolidReconstructor::integrate_all(const SnapshotSource& snapshots,
                                       const std::stop_token& stop) {
  integrate(volume_,
            {.count = snapshots.count,
             .make = [&](std::size_t index) { return condition(snapshots.read(index)); }},
            options_.threads, stop);
}

SurfaceCount SolidReconstructor::surface(const SnapshotSource& snapshots, const FacetSink& sink,
                                         const std::stop_token& stop) {
  if (counted_ && counted_->facets.is_whole()) {
    counted_->facets.stream(sink, stop);
    return counted_->count;
  }
  const CompactTsdf known = integrate_slabs(snapshots, stop);
  ThreadTeam team(options_.threads);
  const HoleFilledSdf sdf = fill_holes(known, stop, team);
  return make_surface(known, sdf, sink, stop, team);
}

SurfaceCount SolidReconstructor::count(const SnapshotSource& snapshots,
                                       const std::stop_token& stop) {
  if (!counted_) {
    const CompactTsdf known = integrate_slabs(snapshots, stop);
    ThreadTeam team(options_.threads);
    const HoleFilledSdf sdf = fill_holes(known, stop, team);
    KeptFacets kept(facets_budget(options_, known.bytes() + volume_.bytes() + mask_bytes(sdf)));
    const SurfaceCount count = make_surface(
        known, sdf, [&](std::span<const Facet> facets) { kept.add(facets); }, stop, team);
    counted_ = Counted{.count = count, .facets = std::move(kept)};
  }
  return counted_->count;
}

SurfaceCount SolidReconstructor::make_surface(const CompactTsdf& known, const HoleFilledSdf& sdf,
                                              const FacetSink& sink, const std::stop_token& stop,
                                              ThreadTeam& team) const {
  expect_room(options_, known.bytes() + mask_bytes(sdf));
  auto [solid, dropped] = keep_parts(sdf, stop, team);
  solid = solid.cropped();  // a mask of the whole box is as large as all that was seen
  solid.remove_spurs(stop);
  solid.fill_cavities(stop);
  const EditedSdf edited(sdf, options_.edits);
  const bool is_edited = options_.edits.change_shape();
  if (is_edited) {
    remove_edited(solid, edited, min_part_voxels(sdf), stop, team);
  }
  SurfaceCount count{.leaves = solid.count(),
                     .facets = 0,
                     .parts = solid.component_count(stop),
                     .dropped_parts = dropped.count,
                     .dropped_leaves = dropped.voxels};
  count.facets = is_edited ? draw_limited(solid, edited, sink, stop, team)
                           : draw_limited(solid, sdf, sink, stop, team);
  return count;
}

/// Draws a mask with as few triangles as the options say. @return their number
template <typename Field>
std::uint64_t SolidReconstructor::draw_limited(const VoxelMask& solid, const Field& field,
                                               const FacetSink& sink, const std::stop_token& stop,
                                               ThreadTeam& team) const {
  const auto draw_with = [&](double target_error, const FacetSink& take) {
    std::uint64_t facets = 0;
    draw(
        solid, field, target_error,
        [&](std::span<const Facet> some) {
          throw_if_stopped(stop);
          facets += some.size();
          take(some);
        },
        stop, team);
    return facets;
  };
  double target_error = options_.target_error;
  if (const auto max = options_.solid.max_triangles) {
    std::uint64_t fewest = std::numeric_limits<std::uint64_t>::max();
    const auto is_too_many = [&](double error) {
      const std::uint64_t count = draw_with(error, [](std::span<const Facet>) {});
      fewest = std::min(fewest, count);
      return count > *max;
    };
    target_error = min_error(target_error, max_error_voxels * field.voxel_side(), is_too_many);
    if (fewest > *max && is_too_many(target_error)) {
      throw Error(ErrorCode::model_too_large,
                  "the model cannot have fewer than " + std::to_string(fewest) + " triangles",
                  "Allow more triangles, or choose a larger leaf size.",
                  {{"least_triangles", static_cast<double>(fewest)}});
    }
  }
  return draw_with(target_error, sink);
}

/// Minimum votes for free space.
int SolidReconstructor::min_votes() const {
  if (!options_.placements.empty()) {
    return min_votes_of_poses;
  }
  return added_ < few_snapshots ? votes_of_any_ray : votes_of_surface_ray;
}

/// Integrates all slabs, reading the snapshots again for each except the one in memory.
CompactTsdf SolidReconstructor::integrate_slabs(const SnapshotSource& snapshots,
                                                const std::stop_token& stop) {
  CompactTsdf known(volume_.grid(), min_votes());
  const int top = volume_.grid().size().z;
  for (int low = 0; low < top; low = volume_.layers().end) {
    if (low != volume_.layers().low) {
      fill_slab(known, low, snapshots, stop);
    }
    ThreadTeam team(options_.threads);
    known.add(volume_, stop, team);
    while (known.bytes() + volume_.bytes() > volume_budget(options_)) {
      if (options_.threads == 1) {
        throw_memory_limit(options_);
      }
      --options_.threads;  // which leaves its memory to the volume
    }
  }
  if (volume_.layers().low > 0) {
    volume_.reset_to_slab(top, 0);  // its bricks are of no more use
  }
  return known;
}

/// The lowest layer of voxels whose samples count: with several poses, the lowest of all.
int SolidReconstructor::base_layer() const {
  if (!options_.placements.empty()) {
    return volume_.grid().low().z * VoxelGrid::brick_side;
  }
  const double bottom = std::max(options_.clip.min.z(), 0.0);
  return static_cast<int>(std::ceil((bottom + base_margin) / volume_.grid().voxel_side() - 0.5));
}

/// Laser lines may leave whole sides of an object unseen: the fill does not swell far there.
std::optional<double> SolidReconstructor::max_bulge() const {
  return sees_lines_ ? std::optional(max_bulge_of_lines) : std::nullopt;
}

/// @throws std::invalid_argument  if the snapshot is of a pose that the options do not list
std::vector<ConditionedDepth> SolidReconstructor::condition(const Snapshot& snapshot) {
  const Placement* placement =
      options_.placements.empty() ? nullptr : &find_placement(snapshot, options_);
  if (!snapshot.strips.empty()) {
    sees_lines_ = true;
    return strip_views(snapshot, options_.clip, placement);
  }
  const Snapshot window = crop(snapshot, volume_.grid().box());
  std::vector<ConditionedDepth> depth;
  if (placement == nullptr) {
    depth.emplace_back(window, options_.clip);
  } else {
    depth.emplace_back(window, options_.clip, *placement);
  }
  return depth;
}

HoleFilledSdf SolidReconstructor::fill_holes(const CompactTsdf& known, const std::stop_token& stop,
                                             ThreadTeam& team) const {
  if (options_.placements.empty()) {
    return {known, base_layer(), stop, team, max_bulge()};
  }
  std::vector<PlatformCut> platforms;
  for (const Placement& placement : options_.placements) {
    platforms.emplace_back(known.grid(), placement);
  }
  return {known, std::move(platforms), stop, team, max_bulge()};
}

/// The components that the model keeps. With several poses none counts as standing.
StandingParts SolidReconstructor::keep_parts(const HoleFilledSdf& sdf, const std::stop_token& stop,
                                             ThreadTeam& team) const {
  if (options_.placements.empty()) {
    return standing_parts(sdf, options_.solid.parts, stop, team);
  }
  StandingParts parts{.mask = sdf.inside(stop, team)};
  parts.dropped = keep_main_component(parts.mask, 0, stop);
  return parts;
}

/// Draws a mask by marching cubes, and simplifies the mesh on its way to the sink.
template <typename Field>
void SolidReconstructor::draw(const VoxelMask& solid, const Field& field, double target_error,
                              const FacetSink& sink, const std::stop_token& stop,
                              ThreadTeam& team) const {
  if (target_error > 0) {
    StreamSimplifier simplifier(mm_from_metres(target_error),
                                mm_from_metres(margin_voxels * field.voxel_side()), sink, stop,
                                team);
    marching_cubes(
        solid, field, [&](const MeshPiece& piece) { simplifier.add(piece); }, stop, team);
    simplifier.finish();
  } else {
    FacetStream facets(sink);
    marching_cubes(
        solid, field, [&](const MeshPiece& piece) { facets.add(piece); }, stop, team);
  }
}

void SolidReconstructor::preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
                                 const std::stop_token& stop) const {
  const VoxelGrid& grid = volume_.grid();
  CompactTsdf known(grid, min_votes());
  known.add(volume_, stop);
  for (int halvings = halvings_to(leaf_size, grid); halvings <= grid.levels(); ++halvings) {
    const std::vector<Facet> facets = observed_surface(known, base_layer(), 1 << halvings, stop);
    if (facets.size() <= max_facets) {
      sink(facets);
      return;
    }
  }
}

}  // namespace octurn
