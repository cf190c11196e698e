#include "bennett/bennett_reconstructor.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bennett/leaf_figures.hpp"
#include "bennett/marching_tetrahedra.hpp"
#include "bennett/triangulate.hpp"
#include "bennett/voxelize_triangle.hpp"
#include "depth/back_project.hpp"
#include "depth/depth_limits.hpp"
#include "depth/find_placement.hpp"
#include "depth/seen_pixels.hpp"
#include "octurn/error.hpp"
#include "octurn/model.hpp"
#include "octurn/units.hpp"
#include "parallel/fork_join.hpp"
#include "voxel/checked_levels.hpp"
#include "voxel/memory_limit.hpp"

namespace octurn {
namespace {

// Memory beside the octrees, measured with frames of 640 x 480 samples: each thread's snapshot, its
// points, and its facets that are not yet streamed.
constexpr std::size_t thread_bytes = 6 * mebibyte;
constexpr std::size_t min_octree_bytes = 1 * mebibyte;

/// @returns the options, if each is in its range
const ReconstructOptions& checked(const ReconstructOptions& options) {
  const int levels = checked_levels(options);
  const auto refuse = [](const std::string& what) { throw Error(ErrorCode::bad_settings, what); };
  if (!std::isfinite(options.threshold) || options.threshold <= 0) {
    refuse("threshold: must be above 0");
  }
  if (options.level && (*options.level < 0 || *options.level > levels)) {
    refuse("level: must be from 0, the root, to " + std::to_string(levels) + ", the leaves");
  }
  check_memory_limit(options.memory_limit,
                     options.program_memory + thread_bytes + min_octree_bytes);
  return options;
}

/// The threads of the options, or as many as fit in the memory limit.
int thread_count(const ReconstructOptions& options) {
  if (options.memory_limit == 0) {
    return options.threads;
  }
  const std::size_t room = options.memory_limit - options.program_memory - min_octree_bytes;
  return std::min(options.threads, static_cast<int>(room / thread_bytes));
}

/// Maximum bytes of each octree: the merged one, and one for each further thread. The list of a
/// layer's pseudo-voxels takes up to as much again.
std::size_t octree_bytes(const ReconstructOptions& options) {
  if (options.memory_limit == 0) {
    return std::numeric_limits<std::size_t>::max();
  }
  const auto threads = static_cast<std::size_t>(thread_count(options));
  return (options.memory_limit - options.program_memory - threads * thread_bytes) / (threads + 1);
}

Octree octree_for(const ReconstructOptions& options) {
  const int leaf_level = Octree::level_for(options.root_size, options.leaf_size);
  return {options.root_size, options.level.value_or(leaf_level), octree_bytes(options)};
}

/// Calls `visit` for bands of rows of the pixels that see a box, one below the other: the points of
/// a whole image take 3.7 MB. The last row of a band is the first of the next.
template <typename Visit>
void for_each_band(const Snapshot& snapshot, const Box& box, Visit visit) {
  constexpr int rows = 32;
  check_size(snapshot.frame, snapshot.intrinsics, "intersection");
  const PixelRectangle all = seen_pixels(snapshot, box);
  PixelRectangle band = all;
  for (; band.top + 1 < all.bottom; band.top += rows) {
    band.bottom = std::min(all.bottom, band.top + rows + 1);
    visit(band);
  }
}

/// The leaves that the surface of a slab depends on: its own, and the lowest of the layer above it.
LeafLayers leaf_layers(const BrickLayers& slab) {
  return {.low = slab.low * Brick::side, .high = slab.end * Brick::side};
}

}  // namespace

// Nodes of a coarser level are found directly, as they are the same (see `voxelize_triangle`).
BennettReconstructor::BennettReconstructor(const ReconstructOptions& options)
    : options_(checked(options)),
      wanted_threads_(options.threads),
      octree_(octree_for(options)),
      slab_(all_layers(octree_)) {
  options_.threads = thread_count(options);
}

void BennettReconstructor::add(const Snapshot& snapshot, const std::stop_token& stop) {
  throw_if_stopped(stop);
  voxelize(snapshot, octree_, slab_);
}

void BennettReconstructor::voxelize(const Snapshot& snapshot, Octree& octree,
                                    BrickLayers& slab) const {
  const SnapGrid snap_grid(octree.side());
  const auto sink = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                        const Eigen::Vector3f& c) {
    const auto p = snap_grid.snap(a);
    const auto q = snap_grid.snap(b);
    const auto r = snap_grid.snap(c);
    if (p && q && r) {
      within_budget(octree, slab,
                    [&] { voxelize_triangle(octree, *p, *q, *r, leaf_layers(slab)); });
    }
  };
  const auto clip_points = [&](PointGrid& grid) {
    clip(grid, options_.clip);
    if (!options_.placements.empty()) {
      clip(grid, find_placement(snapshot, options_));
    }
  };
  const auto threshold = static_cast<float>(options_.threshold);
  for (const LineStrip& strip : snapshot.strips) {
    PointGrid grid{
        .width = static_cast<int>(strip.points.size()), .height = 1, .points = strip.points};
    clip_points(grid);
    for_each_triangle(grid.points, strip.to_next, threshold, sink);
  }
  if (snapshot.strips.empty()) {
    for_each_band(snapshot, options_.clip, [&](const PixelRectangle& band) {
      PointGrid grid = world_points(snapshot, band);
      clip_points(grid);
      triangulate(grid, threshold, sink);
    });
  }
}

/// Calls `fill`; whenever the budget is spent, shrinks the slab and calls it again.
template <typename Fill>
void BennettReconstructor::within_budget(Octree& octree, BrickLayers& slab, Fill fill) const {
  for (bool done = false; !done;) {
    try {
      fill();
      done = true;
    } catch (const OutOfBudget&) {
      shrink_slab(octree, slab);
    }
  }
}

/// Lowers the slab's end, so that its bricks take about half of what they took.
void BennettReconstructor::shrink_slab(Octree& octree, BrickLayers& slab) const {
  std::vector<std::size_t> bricks;  // in the slab's layers
  std::size_t all = 0;
  for (int layer = slab.low; layer < slab.end; ++layer) {
    bricks.push_back(octree.brick_count(layer));
    all += bricks.back();
  }
  if (slab.end - slab.low <= 1) {
    const Eigen::Vector3d sides = (options_.clip.max - options_.clip.min) / octree.leaf_side();
    const double max_bricks = 2 * (sides.x() / Brick::side + 2) * (sides.y() / Brick::side + 2);
    const auto layers =
        static_cast<std::size_t>(max_bricks * 2 * sizeof(Brick));  // and their nodes
    const auto threads = static_cast<std::size_t>(wanted_threads_);
    const std::size_t enough =
        options_.program_memory + threads * thread_bytes + (threads + 1) * layers;
    throw Error(ErrorCode::memory_limit, "memory limit: one layer of the octree does not fit",
                "Allow " + mb_text(enough) + ", or choose a larger leaf size.",
                {{"needed_mb", rounded_up_mb(enough)}});
  }
  std::size_t kept = bricks.front();
  int end = slab.low + 1;
  while (end < slab.end - 1 && kept + bricks[static_cast<std::size_t>(end - slab.low)] <= all / 2) {
    kept += bricks[static_cast<std::size_t>(end - slab.low)];
    ++end;
  }
  slab.end = end;
  octree.remove_layers_from(end + 1);
}

void BennettReconstructor::add(const SnapshotSource& snapshots, const std::stop_token& stop) {
  const int threads = std::min(options_.threads, static_cast<int>(snapshots.count));
  std::vector<std::unique_ptr<Octree>> others(static_cast<std::size_t>(std::max(threads, 1)));
  std::vector<BrickLayers> slabs(others.size(), slab_);
  std::atomic<std::size_t> next = 0;
  fork_join(static_cast<int>(others.size()), [&](int thread) {
    const auto i = static_cast<std::size_t>(thread);
    if (i > 0) {
      others[i] = std::make_unique<Octree>(octree_for(options_));
    }
    Octree& octree = i > 0 ? *others[i] : octree_;
    for (std::size_t shot = next++; shot < snapshots.count; shot = next++) {
      throw_if_stopped(stop);
      voxelize(snapshots.read(shot), octree, slabs[i]);
    }
  });
  slab_ = *std::ranges::min_element(slabs, {}, &BrickLayers::end);
  octree_.remove_layers_from(slab_.end + 1);
  for (std::size_t i = 1; i < others.size(); ++i) {
    throw_if_stopped(stop);
    merge(*std::exchange(others[i], nullptr));
  }
}

void BennettReconstructor::merge(Octree& other) {
  within_budget(octree_, slab_, [&] {
    other.remove_layers_from(slab_.end + 1);
    octree_.merge(other);
  });
}

void BennettReconstructor::begin_slab(const BrickLayers& slab, const SnapshotSource& snapshots,
                                      const std::stop_token& stop) {
  octree_.clear();
  slab_ = slab;
  add(snapshots, stop);
}

template <typename Visit>
void BennettReconstructor::for_each_slab(const SnapshotSource& snapshots,
                                         const std::stop_token& stop, Visit visit) {
  const int top = octree_.brick_layers();
  if (slab_.low > 0) {
    begin_slab(all_layers(octree_), snapshots, stop);
  }
  visit(slab_);
  while (slab_.end < top) {
    // The next slab most likely takes about as many layers as this one.
    const int height = 2 * (slab_.end - slab_.low);
    begin_slab({.low = slab_.end, .end = std::min(top, slab_.end + height)}, snapshots, stop);
    visit(slab_);
  }
}

/// Streams the surface of a slab, and adds it to `count`.
void BennettReconstructor::draw(const BrickLayers& slab, const FacetSink& sink,
                                const std::stop_token& stop, SurfaceCount& count) const {
  throw_if_stopped(stop);
  count.leaves += octree_.leaf_count(slab.low, slab.end);
  marching_tetrahedra(octree_, slab, options_.threads, [&](std::span<const Facet> facets) {
    throw_if_stopped(stop);
    count.facets += facets.size();
    sink(facets);
  });
}

SurfaceCount BennettReconstructor::surface(const SnapshotSource& snapshots, const FacetSink& sink,
                                           const std::stop_token& stop) {
  SurfaceCount count;
  for_each_slab(snapshots, stop, [&](const BrickLayers& slab) { draw(slab, sink, stop, count); });
  return count;
}

ModelReport BennettReconstructor::measured_surface(const SnapshotSource& snapshots,
                                                   const FacetSink& sink,
                                                   const std::stop_token& stop) {
  SurfaceCount count;
  LeafFigures figures(octree_);
  for_each_slab(snapshots, stop, [&](const BrickLayers& slab) {
    draw(slab, sink, stop, count);
    figures.add(octree_, slab);
  });
  if (count.facets == 0) {
    return {};
  }
  const Box bounds = figures.bounds();
  return {.leaves = count.leaves,
          .triangles = count.facets,
          .bytes = stl_bytes(count.facets),
          .places = {.surface = std::make_shared<SurfaceCells>(figures.surface()),
                     .leaves = figures.sample()},
          .watertight = figures.closed(),
          .volume = figures.volume(),
          .size = bounds.max - bounds.min,
          .bottom = bounds.min.z()};
}

SurfaceCount BennettReconstructor::count(const SnapshotSource& snapshots,
                                         const std::stop_token& stop) {
  SurfaceCount count;
  for_each_slab(snapshots, stop, [&](const BrickLayers& slab) {
    throw_if_stopped(stop);
    count.leaves += octree_.leaf_count(slab.low, slab.end);
    count.facets += count_facets(octree_, slab);
  });
  return count;
}

void BennettReconstructor::preview(double leaf_size, std::uint64_t max_facets,
                                   const FacetSink& sink, const std::stop_token& stop) const {
  throw_if_stopped(stop);
  const int level = std::min(Octree::level_for(octree_.side(), leaf_size), octree_.levels());
  coarse_surface(octree_.at_level(level), max_facets, sink);
}

}  // namespace octurn
