#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <vector>

#include "depth/condition_depth.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {

/// What snapshots observed, by their index: one conditioned depth image, or several of a scan by
/// laser line. Made by several threads at once.
struct ConditionedSource {
  std::size_t count = 0;
  std::function<std::vector<ConditionedDepth>(std::size_t)> make = {};
};

/// Makes and integrates all snapshots of a scan, in their order, on several threads.
///
/// A volume that holds all its bricks is filled by as many snapshots at once as there are threads:
/// made in parallel, then integrated in parallel. Of one that may have to drop layers snapshots are
/// made in parallel, and integrated one after the other. The bits are the same.
///
/// @throws OutOfBudget, Stopped  and what the source throws
void integrate(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
               const std::stop_token& stop = {});

}  // namespace octurn
