#include "tsdf/solid_reconstructor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "depth/condition_depth.hpp"
#include "depth/crop.hpp"
#include "depth/placement_of.hpp"
#include "mesh/stream_simplifier.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "parallel/fork_join.hpp"
#include "parallel/ordered_pipeline.hpp"
#include "tsdf/facet_stream.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/marching_cubes.hpp"
#include "voxel/checked_levels.hpp"
#include "voxel/memory_limit.hpp"
#include "voxel/out_of_budget.hpp"

namespace octurn {
namespace {

// Truncation distance: 3 sigma of a Kinect v1's noise at 0.65 m, and at least 2.5 voxels.
constexpr double truncation = 0.0035;  // metres
constexpr double min_truncation_voxels = 2.5;
constexpr double foot_room = 1.5;  // truncations below the platform of the first of several poses

// The lowest layers of the clip box hold some of the platform's noise: the base layer is the first
// one this far above the box's bottom.
constexpr double base_margin = 0.001;  // metres

// Memory beside the volume, measured with frames of 640 x 480 samples: each thread's snapshot and
// conditioned depth; the simplifier's window.
constexpr std::size_t thread_bytes = 14 * mebibyte;
constexpr std::size_t surface_bytes = 16 * mebibyte;
constexpr std::size_t min_volume_bytes = 4 * mebibyte;

/// The simplifier's margin below the upper end of its window.
constexpr double margin_voxels = 8;

std::size_t fixed_overhead(const ReconstructOptions& options) {
  return options.program_memory +
         std::max(static_cast<std::size_t>(options.threads) * thread_bytes, surface_bytes);
}

/// @return the options, with no more threads than the memory limit leaves room for
ReconstructOptions checked(ReconstructOptions options) {
  checked_levels(options);
  if (options.level) {
    throw Error(ErrorCode::bad_settings, "level: the method solid has none");
  }
  if (!std::isfinite(options.target_error) || options.target_error < 0) {
    throw Error(ErrorCode::bad_settings, "max error: must be 0 or above");
  }
  const auto min_bytes = [&] { return fixed_overhead(options) + min_volume_bytes; };
  while (options.memory_limit != 0 && options.threads > 1 && min_bytes() > options.memory_limit) {
    --options.threads;
  }
  check_memory_limit(options.memory_limit, min_bytes());
  return options;
}

/// Bytes that the volume and the compact TSDF may take together.
std::size_t volume_budget(const ReconstructOptions& options) {
  return options.memory_limit == 0 ? std::numeric_limits<std::size_t>::max()
                                   : options.memory_limit - fixed_overhead(options);
}

/// Bytes that a slab of the volume may take, so that its compact form fits beside it.
/// @param known  the slabs that are finished
std::size_t slab_budget(const ReconstructOptions& options, const CompactTsdf& known) {
  constexpr double share =
      static_cast<double>(sizeof(TsdfBrick)) / (sizeof(TsdfBrick) + sizeof(CompactBrick));
  const std::size_t all = volume_budget(options);
  const std::size_t taken = known.bytes() + BlockPool<CompactBrick>::block_bytes;
  return all > taken ? static_cast<std::size_t>(share * static_cast<double>(all - taken)) : 0;
}

/// Snapshots that make free space: of several poses a few, as one that errs would open the inside,
/// which no other pose closes.
int min_free(const ReconstructOptions& options) { return options.placements.empty() ? 1 : 3; }

VoxelGrid make_grid(const ReconstructOptions& options) {
  const int levels = checked_levels(options);
  const double voxel_side = options.root_size / (1 << levels);
  const double distance = std::max(truncation, min_truncation_voxels * voxel_side);
  // Of several poses, room for the surface of a foot that is seen from below.
  const int below = options.placements.empty()
                        ? 0
                        : static_cast<int>(std::ceil(foot_room * distance /
                                                     (voxel_side * VoxelGrid::brick_side)));
  return {options.root_size, levels, options.clip, distance, below};
}

[[noreturn]] void throw_memory_limit(const ReconstructOptions& options) {
  throw Error(ErrorCode::memory_limit,
              "memory limit: " + mb_text(options.memory_limit) + " do not hold what was seen",
              "Allow " + mb_text(2 * options.memory_limit) + ", or choose a larger leaf size.");
}

/// Bytes of the mask of an SDF's box, and half as much to find its components.
std::size_t mask_bytes(const HoleFilledSdf& sdf) {
  const auto side = [](int low, int end) { return static_cast<std::size_t>(end - low); };
  return side(sdf.low().x, sdf.end().x) * side(sdf.low().y, sdf.end().y) *
         side(sdf.low().z, sdf.end().z) / 16 * 3;
}

/// The times that voxels can be merged, eight in one, until their side would exceed `leaf_size`.
int halvings_to(double leaf_size, const VoxelGrid& grid) {
  int halvings = 0;
  while (halvings < grid.levels() && grid.voxel_side() * (2 << halvings) <= leaf_size) {
    ++halvings;
  }
  return halvings;
}

}  // namespace

SolidReconstructor::SolidReconstructor(const ReconstructOptions& options)
    : options_(checked(options)),
      volume_(make_grid(options_), slab_budget(options_, CompactTsdf(make_grid(options_)))) {}

void SolidReconstructor::add(const Snapshot& snapshot, const std::stop_token& stop) try {
  throw_if_stopped(stop);
  integrate(volume_, condition(snapshot), stop);
} catch (const OutOfBudget&) {
  throw_memory_limit(options_);
}

/// Snapshots are read and conditioned in parallel, and integrated in their order.
void SolidReconstructor::add(const SnapshotSource& snapshots, const std::stop_token& stop) try {
  const int threads = std::clamp(static_cast<int>(snapshots.count), 1, options_.threads);
  auto next = [&, index = std::size_t{0}]() mutable -> std::optional<std::size_t> {
    throw_if_stopped(stop);
    return index < snapshots.count ? std::optional(index++) : std::nullopt;
  };
  OrderedPipeline<decltype(next), std::optional<ConditionedDepth>> pipeline(next, threads);
  fork_join(threads, [&](int) {
    pipeline.run(
        [&](std::size_t index, std::optional<ConditionedDepth>& depth) {
          depth.emplace(condition(snapshots.read(index)));
        },
        [&](std::optional<ConditionedDepth>& depth) {
          integrate(volume_, *depth, stop);
          depth.reset();
        });
  });
} catch (const OutOfBudget&) {
  throw_memory_limit(options_);
}

SurfaceCount SolidReconstructor::surface(const SnapshotSource& snapshots, const FacetSink& sink,
                                         const std::stop_token& stop) {
  const CompactTsdf known = integrate_slabs(snapshots, stop);
  const HoleFilledSdf sdf = fill_holes(known, stop);
  expect_room_for_masks(known, sdf);
  VoxelMask solid = sdf.inside(stop);
  const std::uint64_t all = solid.count();
  solid.keep_main_component(stop);
  const std::uint64_t dropped = all - solid.count();
  solid = solid.cropped();
  solid.remove_spurs(stop);
  solid.fill_cavities(stop);
  SurfaceCount count{.leaves = solid.count(),
                     .facets = 0,
                     .parts = solid.component_count(stop),
                     .dropped_leaves = dropped};
  draw(
      solid, sdf,
      [&](std::span<const Facet> facets) {
        throw_if_stopped(stop);
        count.facets += facets.size();
        sink(facets);
      },
      stop);
  return count;
}

SurfaceCount SolidReconstructor::count(const SnapshotSource& snapshots,
                                       const std::stop_token& stop) {
  return surface(
      snapshots, [](std::span<const Facet>) {}, stop);
}

/// Integrates all slabs, reading the snapshots again for each but the one in memory.
CompactTsdf SolidReconstructor::integrate_slabs(const SnapshotSource& snapshots,
                                                const std::stop_token& stop) {
  CompactTsdf known(volume_.grid(), min_free(options_));
  const int top = volume_.grid().size().z;
  for (int low = 0; low < top; low = volume_.layers().end) {
    if (low != volume_.layers().low) {
      volume_.reset_to_slab(low, slab_budget(options_, known));
      add(snapshots, stop);
    }
    known.add(volume_, stop);
    if (known.bytes() + volume_.bytes() > volume_budget(options_)) {
      throw_memory_limit(options_);
    }
  }
  if (volume_.layers().low > 0) {
    volume_.reset_to_slab(top, 0);  // its bricks are of no more use
  }
  return known;
}

/// @throws Error "memory-limit"
void SolidReconstructor::expect_room_for_masks(const CompactTsdf& known,
                                               const HoleFilledSdf& sdf) const {
  if (options_.memory_limit != 0 &&
      options_.program_memory + known.bytes() + mask_bytes(sdf) > options_.memory_limit) {
    throw_memory_limit(options_);
  }
}

/// The lowest layer of voxels whose samples count.
int SolidReconstructor::base_layer() const {
  const double bottom = std::max(options_.clip.min.z(), 0.0);
  return static_cast<int>(std::ceil((bottom + base_margin) / volume_.grid().voxel_side() - 0.5));
}

/// @throws std::invalid_argument  if the snapshot is of a pose that the options do not list
ConditionedDepth SolidReconstructor::condition(const Snapshot& snapshot) const {
  const Snapshot window = crop(snapshot, volume_.grid().box());
  if (options_.placements.empty()) {
    return {window, options_.clip};
  }
  return {window, options_.clip, placement_of(snapshot, options_)};
}

HoleFilledSdf SolidReconstructor::fill_holes(const CompactTsdf& known,
                                             const std::stop_token& stop) const {
  if (options_.placements.empty()) {
    return {known, base_layer(), stop};
  }
  std::vector<PlatformCut> platforms;
  for (const Placement& placement : options_.placements) {
    platforms.emplace_back(known.grid(), placement);
  }
  return {known, std::move(platforms), stop};
}

/// Draws a mask by marching cubes, and simplifies the mesh on its way to the sink.
void SolidReconstructor::draw(const VoxelMask& solid, const HoleFilledSdf& sdf,
                              const FacetSink& sink, const std::stop_token& stop) const {
  if (options_.target_error > 0) {
    StreamSimplifier simplifier(mm_from_metres(options_.target_error),
                                mm_from_metres(margin_voxels * sdf.voxel_side()), sink, stop);
    marching_cubes(
        solid, sdf, [&](const MeshPiece& piece) { simplifier.add(piece); }, stop);
    simplifier.finish();
  } else {
    FacetStream facets(sink);
    marching_cubes(
        solid, sdf, [&](const MeshPiece& piece) { facets.add(piece); }, stop);
  }
}

void SolidReconstructor::preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
                                 const std::stop_token& stop) const {
  const VoxelGrid& grid = volume_.grid();
  CompactTsdf known(grid, min_free(options_));
  known.add(volume_, stop);
  VoxelMask mask = fill_holes(known, stop).inside(stop);
  mask.keep_main_component(stop);
  int halvings = 0;
  for (; halvings < halvings_to(leaf_size, grid); ++halvings) {
    mask = mask.halved(stop);
  }
  const auto draw_mask = [&](const FacetSink& to) {
    FacetStream facets(to);
    marching_cubes(
        mask, grid.root_side(), grid.voxel_side() * (1 << halvings),
        [&](const MeshPiece& piece) { facets.add(piece); }, stop);
  };
  const auto facet_count = [&] {
    std::uint64_t count = 0;
    draw_mask([&](std::span<const Facet> facets) { count += facets.size(); });
    return count;
  };
  for (; halvings < grid.levels() && facet_count() > max_facets; ++halvings) {
    mask = mask.halved(stop);
  }
  draw_mask(sink);
}

}  // namespace octurn
