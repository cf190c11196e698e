#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <vector>

#include "depth/condition_depth.hpp"
#include "tsdf/tsdf_volume.hpp"

namespace octurn {

/// Makes the observations of the snapshot with an index: one conditioned depth image, or several
/// for a scan by laser line. Called by several threads at once.
struct ConditionedSource {
  std::size_t count = 0;
  std::function<std::vector<ConditionedDepth>(std::size_t)> make = {};
};

/// Makes and integrates all snapshots of a scan, in their order, on several threads.
///
/// If the volume can hold all its bricks, as many snapshots as there are threads are conditioned in
/// parallel, then integrated in parallel. If it may have to drop layers, they are integrated one
/// after the other. The bits are the same.
///
/// @throws OutOfBudget, Stopped  and what the source throws
void integrate(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
               const std::stop_token& stop = {});

}  // namespace octurn
