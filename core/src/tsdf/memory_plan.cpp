#include "tsdf/memory_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "io/number_text.hpp"
#include "octurn/error.hpp"
#include "tsdf/tsdf_volume.hpp"
#include "tsdf/voxel_grid.hpp"
#include "voxel/block_pool.hpp"
#include "voxel/checked_levels.hpp"
#include "voxel/memory_limit.hpp"

namespace octurn {
namespace {

// Memory beside the volume, measured with frames of 640 x 480 samples: each thread's snapshot and
// conditioned depth; the simplifier's window.
constexpr std::size_t thread_bytes = 14 * mebibyte;
constexpr std::size_t surface_bytes = 14 * mebibyte;
constexpr std::size_t min_volume_bytes = 4 * mebibyte;

// Of facets that are kept where there is no limit: 2.7 million.
constexpr std::size_t unlimited_facets_bytes = 128 * mebibyte;

// The object that memory is expected for: a cube, whose surface meets half as many bricks more as
// if it were level.
constexpr double usual_side = 0.1;  // metres
constexpr double bricks_by_slope = 1.5;

/// The fixed memory of program and threads. The threads' snapshots are freed before the surface is
/// made, and its window takes no more than they did.
std::size_t fixed_overhead(const ReconstructOptions& options) {
  static_assert(surface_bytes <= thread_bytes);
  return options.program_memory + static_cast<std::size_t>(options.threads) * thread_bytes;
}

/// Bytes of the tables of bricks and blocks, of the volume and of its compact form.
std::size_t table_bytes(const VoxelGrid& grid) {
  return 2 * (grid.brick_count() * sizeof(std::uint32_t) + grid.block_count());
}

/// The memory that the options need for the smallest model, bytes.
std::size_t min_bytes(const ReconstructOptions& options) {
  return fixed_overhead(options) +
         std::max(min_volume_bytes, table_bytes(make_solid_grid(options)));
}

std::size_t usual_bytes(const ReconstructOptions& options) {
  const VoxelGrid grid = make_solid_grid(options);
  const Eigen::Vector3d clip = options.clip.max - options.clip.min;
  const double side = std::min(usual_side, clip.minCoeff());
  const double brick = grid.voxel_side() * VoxelGrid::brick_side;
  const double bricks =
      6 * std::pow(side / brick, 2) * bricks_by_slope * (2 * grid.truncation() / brick + 1);
  const double mask = clip.x() * clip.y() * side / std::pow(grid.voxel_side(), 3) * 3 / 16;
  const double surface = bricks * sizeof(CompactBrick) + mask;
  return std::max(min_bytes(options), options.program_memory + surface_bytes + table_bytes(grid) +
                                          static_cast<std::size_t>(surface));
}

/// The options' leaf size, doubled until the memory that it needs is within the limit.
double fitting_leaf(ReconstructOptions options,
                    std::size_t (*needed_bytes)(const ReconstructOptions&)) {
  while (options.memory_limit != 0 && 2 * options.leaf_size <= options.root_size &&
         needed_bytes(options) > options.memory_limit) {
    options.leaf_size *= 2;
  }
  return options.leaf_size;
}

/// @throws Error "memory-limit"  with the memory that is enough, or a leaf size that fits
void expect_memory(const ReconstructOptions& options) {
  const std::size_t needed = min_bytes(options);
  if (options.memory_limit == 0 || needed <= options.memory_limit) {
    return;
  }
  ReconstructOptions coarser = options;
  coarser.leaf_size = fitting_leaf(options, min_bytes);
  const bool fits = min_bytes(coarser) <= options.memory_limit;
  throw Error(
      ErrorCode::memory_limit, "memory limit: " + mb_text(options.memory_limit) + " is too little",
      "Allow at least " + mb_text(needed) +
          (fits ? ", or choose a leaf size of " + mm_text(coarser.leaf_size) : "") + ".",
      {{"limit_mb", rounded_up_mb(options.memory_limit)}, {"needed_mb", rounded_up_mb(needed)}});
}

}  // namespace

MemoryNeed expected_memory(const ReconstructOptions& options) {
  ReconstructOptions alone = options;
  alone.threads = 1;  // further threads use the memory that is left
  return {.bytes = usual_bytes(alone), .fitting_leaf_size = fitting_leaf(alone, usual_bytes)};
}

ReconstructOptions checked_solid_options(ReconstructOptions options) {
  checked_levels(options);
  if (options.level) {
    throw Error(ErrorCode::bad_settings, "level: the method solid has none");
  }
  if (!std::isfinite(options.solid.truncation) || options.solid.truncation <= 0) {
    throw Error(ErrorCode::bad_settings, "truncation: must be above 0");
  }
  if (!std::isfinite(options.target_error) || options.target_error < 0) {
    throw Error(ErrorCode::bad_settings, "max error: must be 0 or above");
  }
  // At most half for threads, as a volume in many slabs is slower than fewer threads.
  while (options.memory_limit != 0 && options.threads > 1 &&
         options.program_memory + 2 * static_cast<std::size_t>(options.threads) * thread_bytes >
             options.memory_limit) {
    --options.threads;
  }
  expect_memory(options);
  return options;
}

std::size_t volume_budget(const ReconstructOptions& options) {
  return options.memory_limit == 0 ? std::numeric_limits<std::size_t>::max()
                                   : options.memory_limit - fixed_overhead(options);
}

std::size_t slab_budget(const ReconstructOptions& options, const CompactTsdf& known) {
  constexpr double share =
      static_cast<double>(sizeof(TsdfBrick)) / (sizeof(TsdfBrick) + sizeof(CompactBrick));
  const std::size_t all = volume_budget(options);
  const std::size_t taken = known.bytes() + BlockPool<CompactBrick>::block_bytes;
  return all > taken ? static_cast<std::size_t>(share * static_cast<double>(all - taken)) : 0;
}

std::size_t mask_bytes(const HoleFilledSdf& sdf) {
  const auto side = [](int low, int end) { return static_cast<std::size_t>(end - low); };
  return side(sdf.low().x, sdf.end().x) * side(sdf.low().y, sdf.end().y) *
         side(sdf.low().z, sdf.end().z) / 16 * 3;
}

void expect_room(const ReconstructOptions& options, std::size_t bytes) {
  if (options.memory_limit != 0 && options.program_memory + bytes > options.memory_limit) {
    throw_memory_limit(options);
  }
}

std::size_t facets_budget(const ReconstructOptions& options, std::size_t taken) {
  if (options.memory_limit == 0) {
    return unlimited_facets_bytes;
  }
  const std::size_t all = options.program_memory + surface_bytes + taken;
  return options.memory_limit > all ? options.memory_limit - all : 0;
}

void throw_memory_limit(const ReconstructOptions& options) {
  throw Error(ErrorCode::memory_limit,
              "memory limit: " + mb_text(options.memory_limit) + " do not hold what was seen",
              "Allow " + mb_text(2 * options.memory_limit) + ", or choose a larger leaf size.",
              {{"limit_mb", rounded_up_mb(options.memory_limit)}});
}

}  // namespace octurn
