#include "voxel/checked_levels.hpp"

#include <cmath>
#include <string>

#include "io/number_text.hpp"
#include "octurn/error.hpp"
#include "voxel/octree.hpp"

namespace octurn {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw Error(ErrorCode::bad_settings, what); }

}  // namespace

int checked_levels(const ReconstructOptions& options) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  const double finest = options.root_size / (1 << Octree::max_levels);
  if (!positive(options.root_size)) {
    refuse("root size: must be above 0");
  }
  if (!positive(options.leaf_size) || options.leaf_size > options.root_size ||
      options.leaf_size < finest) {
    refuse("leaf size: must be from " + mm_text(finest) + " to the root's " +
           mm_text(options.root_size));
  }
  if (!options.clip.min.allFinite() || !options.clip.max.allFinite() ||
      (options.clip.min.array() >= options.clip.max.array()).any()) {
    refuse("clip box: its minimum must be below its maximum on each axis");
  }
  if (options.threads < 1) {
    refuse("threads: must be at least 1");
  }
  return Octree::level_for(options.root_size, options.leaf_size);
}

}  // namespace octurn
