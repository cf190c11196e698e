#include "tsdf/solid_reconstructor.hpp"

#include <malloc.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "bennett/marching_tetrahedra.hpp"
#include "depth/condition_depth.hpp"
#include "depth/crop.hpp"
#include "mesh/stream_simplifier.hpp"
#include "octurn/error.hpp"
#include "octurn/units.hpp"
#include "parallel/fork_join.hpp"
#include "parallel/ordered_pipeline.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/marching_cubes.hpp"
#include "voxel/checked_levels.hpp"
#include "voxel/memory_limit.hpp"

namespace octurn {
namespace {

// Distances are kept this far from a surface: three times a Kinect's noise at 0.65 m, but no less
// than the leaves need.
constexpr double truncation = 0.0035;  // metres
constexpr double least_truncation_leaves = 2.5;

// The lowest layers of the clip box are partly the platform's noise: the first that counts is this
// far above its bottom.
constexpr double base_margin = 0.001;  // metres

// What a process takes beside its field, measured with a sensor's 640 x 480 samples: the program
// and its libraries, for each thread a snapshot and what it says, and the mesh on its way out.
constexpr std::size_t program_bytes = 12 * mebibyte;
constexpr std::size_t thread_bytes = 14 * mebibyte;
constexpr std::size_t surface_bytes = 16 * mebibyte;
constexpr std::size_t least_field_bytes = 4 * mebibyte;
constexpr int large_block_bytes = 1 << 20;  // go back to the system when they are freed

/// How far below the upper end of its window a mesh is simplified, in leaves.
constexpr double margin_leaves = 8;

std::size_t beside_field(const ReconstructOptions& options) {
  return program_bytes +
         std::max(static_cast<std::size_t>(options.threads) * thread_bytes, surface_bytes);
}

/// @returns the options, with as many threads as asked for, or as the memory limit leaves room for
ReconstructOptions checked(ReconstructOptions options) {
  checked_levels(options);
  if (options.level) {
    throw Error("bad-settings", "level: the method solid has none");
  }
  if (!std::isfinite(options.target_error) || options.target_error < 0) {
    throw Error("bad-settings", "max error: must be 0 or above");
  }
  const auto least = [&] { return beside_field(options) + least_field_bytes; };
  while (options.memory_limit != 0 && options.threads > 1 && least() > options.memory_limit) {
    --options.threads;
  }
  check_memory_limit(options.memory_limit, least());
  return options;
}

/// What a field and what is left of it may take together, bytes.
std::size_t room(const ReconstructOptions& options) {
  return options.memory_limit == 0 ? std::numeric_limits<std::size_t>::max()
                                   : options.memory_limit - beside_field(options);
}

/// What a slab of the field may take, so that there is room for what is left of it.
/// @param seen  what is left of other slabs
std::size_t slab_room(const ReconstructOptions& options, const CompactTsdf& seen) {
  constexpr double share =
      static_cast<double>(sizeof(TsdfBrick)) / (sizeof(TsdfBrick) + sizeof(CompactBrick));
  const std::size_t all = room(options);
  const std::size_t taken = seen.bytes() + BlockPool<CompactBrick>::block_bytes;
  return all > taken ? static_cast<std::size_t>(share * static_cast<double>(all - taken)) : 0;
}

VoxelGrid shape_for(const ReconstructOptions& options) {
  const int levels = checked_levels(options);
  const double leaf_side = options.root_size / (1 << levels);
  return {options.root_size, levels, options.clip,
          std::max(truncation, least_truncation_leaves * leaf_side)};
}

[[noreturn]] void refuse_field(const ReconstructOptions& options) {
  throw Error("memory-limit",
              "memory limit: " + mb_text(options.memory_limit) + " do not hold what was seen",
              "Allow " + mb_text(2 * options.memory_limit) + ", or choose a larger leaf size.");
}

/// What the leaves of a field's box take, a bit for each, and half as much to find their parts.
std::size_t leaf_set_bytes(const HoleFilledSdf& filled) {
  const auto side = [](int low, int end) { return static_cast<std::size_t>(end - low); };
  return side(filled.low().x, filled.end().x) * side(filled.low().y, filled.end().y) *
         side(filled.low().z, filled.end().z) / 16 * 3;
}

/// Facets of a mesh as it comes, with all its triangles.
class Facets {
 public:
  explicit Facets(const FacetSink& sink) : sink_(sink) {}

  void add(const MeshPiece& piece) {
    // Triangles have no vertices but those of this piece and of the one before.
    vertices_.erase(vertices_.begin(), vertices_.end() - static_cast<std::ptrdiff_t>(last_));
    first_ = next_ - static_cast<std::uint32_t>(last_);
    last_ = piece.vertices.size();
    next_ += static_cast<std::uint32_t>(last_);
    vertices_.insert(vertices_.end(), piece.vertices.begin(), piece.vertices.end());
    facets_.clear();
    for (const MeshTriangle& triangle : piece.triangles) {
      facets_.push_back(to_facet({vertices_[triangle[0] - first_], vertices_[triangle[1] - first_],
                                  vertices_[triangle[2] - first_]}));
    }
    sink_(facets_);
  }

 private:
  const FacetSink& sink_;
  std::vector<MeshVertex> vertices_ = {};
  std::vector<Facet> facets_ = {};
  std::size_t last_ = 0;  // vertices of the last piece
  std::uint32_t first_ = 0;
  std::uint32_t next_ = 0;
};

}  // namespace

SolidReconstructor::SolidReconstructor(const ReconstructOptions& options)
    : options_(checked(options)),
      field_(shape_for(options_), slab_room(options_, CompactTsdf(shape_for(options_)))) {
  if (options_.memory_limit != 0) {
    // Else the C library keeps what one thread frees for that thread alone: 24 MB with two threads.
    ::mallopt(M_MMAP_THRESHOLD, large_block_bytes);
  }
}

void SolidReconstructor::add(const Snapshot& snapshot, const std::stop_token& stop) {
  add({.count = 1, .read = [&](std::size_t) { return snapshot; }}, stop);
}

void SolidReconstructor::add(const SnapshotSource& snapshots, const std::stop_token& stop) try {
  const int threads = std::clamp(static_cast<int>(snapshots.count), 1, options_.threads);
  auto next = [&, shot = std::size_t{0}]() mutable -> std::optional<std::size_t> {
    throw_if_stopped(stop);
    return shot < snapshots.count ? std::optional(shot++) : std::nullopt;
  };
  OrderedPipeline<decltype(next), std::optional<ConditionedDepth>> shots(next, threads);
  fork_join(threads, [&](int) {
    shots.run(
        [&](std::size_t shot, std::optional<ConditionedDepth>& sighting) {
          sighting.emplace(crop(snapshots.read(shot), field_.box()), options_.clip);
        },
        [&](std::optional<ConditionedDepth>& sighting) {
          fuse(field_, *sighting, stop);
          sighting.reset();
        });
  });
} catch (const OutOfBudget&) {
  refuse_field(options_);
}

/// What all snapshots say, slab by slab.
CompactTsdf SolidReconstructor::seen(const SnapshotSource& snapshots, const std::stop_token& stop) {
  CompactTsdf seen(field_);
  const auto add_slab = [&](int low) {
    if (low != field_.layers().low) {
      field_.begin(low, slab_room(options_, seen));
      add(snapshots, stop);
    }
    seen.add(field_, stop);
    if (seen.bytes() + field_.bytes() > room(options_)) {
      refuse_field(options_);
    }
  };
  add_slab(0);
  while (field_.layers().end < field_.size().z) {
    add_slab(field_.layers().end);
  }
  if (field_.layers().low > 0) {
    field_.begin(field_.size().z, 0);  // what it holds is of no more use
  }
  if (options_.memory_limit != 0) {
    ::malloc_trim(0);  // the C library would keep what slabs and sightings took
  }
  return seen;
}

/// The lowest layer of leaves that counts.
int SolidReconstructor::foot() const {
  const double bottom = std::max(options_.clip.min.z(), 0.0);
  return static_cast<int>(std::ceil((bottom + base_margin) / field_.leaf_side() - 0.5));
}

SurfaceCount SolidReconstructor::surface(const SnapshotSource& snapshots, const FacetSink& sink,
                                         const std::stop_token& stop) {
  const CompactTsdf seen = this->seen(snapshots, stop);
  const HoleFilledSdf filled(seen, foot(), stop);
  if (options_.memory_limit != 0 &&
      program_bytes + seen.bytes() + leaf_set_bytes(filled) > options_.memory_limit) {
    refuse_field(options_);
  }
  VoxelMask part = filled.inside(stop);
  part.keep_main_component(stop);
  part = part.cropped();
  part.remove_spurs(stop);
  part.fill_cavities(stop);
  SurfaceCount count{.leaves = part.count(), .facets = 0, .parts = part.component_count(stop)};
  const FacetSink counted = [&](std::span<const Facet> facets) {
    throw_if_stopped(stop);
    count.facets += facets.size();
    sink(facets);
  };
  if (options_.target_error > 0) {
    StreamSimplifier simplifier(mm_from_metres(options_.target_error),
                                mm_from_metres(margin_leaves * field_.leaf_side()), counted, stop);
    marching_cubes(
        part, filled, [&](const MeshPiece& piece) { simplifier.add(piece); }, stop);
    simplifier.finish();
  } else {
    Facets facets(counted);
    marching_cubes(
        part, filled, [&](const MeshPiece& piece) { facets.add(piece); }, stop);
  }
  return count;
}

SurfaceCount SolidReconstructor::count(const SnapshotSource& snapshots,
                                       const std::stop_token& stop) {
  return surface(
      snapshots, [](std::span<const Facet>) {}, stop);
}

void SolidReconstructor::preview(double leaf_size, std::uint64_t max_facets, const FacetSink& sink,
                                 const std::stop_token& stop) const {
  const int level = std::min(Octree::level_of(field_.side(), leaf_size), field_.levels());
  const int finer = field_.levels() - level;
  CompactTsdf seen(field_);
  seen.add(field_, stop);
  const HoleFilledSdf filled(seen, foot(), stop);
  VoxelMask part = filled.inside(stop);
  part.keep_main_component(stop);
  Octree coarse(field_.side(), level);
  for (int z = 0; z < part.size().z; ++z) {
    for (int y = 0; y < part.size().y; ++y) {
      const auto row = part.row(y, z);
      for (std::size_t word = 0; word < row.size(); ++word) {
        for (std::uint64_t rest = row[word]; rest != 0; rest &= rest - 1) {
          const int x = static_cast<int>(word) * 64 + std::countr_zero(rest);
          coarse.set({(part.low().x + x) >> finer, (part.low().y + y) >> finer,
                      (part.low().z + z) >> finer});
        }
      }
    }
  }
  coarse_surface(std::move(coarse), max_facets, sink);
}

}  // namespace octurn
