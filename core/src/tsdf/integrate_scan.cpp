#include "tsdf/integrate_scan.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "parallel/fork_join.hpp"
#include "parallel/ordered_pipeline.hpp"
#include "parallel/thread_team.hpp"
#include "tsdf/integrate.hpp"

namespace octurn {
namespace {

void integrate_in_parallel(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
                           const std::stop_token& stop) {
  ThreadTeam team(threads);
  const auto at_once = static_cast<std::size_t>(threads);
  for (std::size_t first = 0; first < snapshots.count; first += at_once) {
    const std::size_t count = std::min(at_once, snapshots.count - first);
    std::vector<std::vector<ConditionedDepth>> depths(count);
    team.for_each(static_cast<int>(count), [&](int i) {
      throw_if_stopped(stop);
      const auto index = static_cast<std::size_t>(i);
      depths[index] = snapshots.make(first + index);
    });
    std::vector<const ConditionedDepth*> in_order;
    for (const std::vector<ConditionedDepth>& of_snapshot : depths) {
      for (const ConditionedDepth& depth : of_snapshot) {
        in_order.push_back(&depth);
      }
    }
    integrate(volume, in_order, team, stop);
  }
}

void integrate_in_order(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
                        const std::stop_token& stop) {
  threads = std::clamp(static_cast<int>(snapshots.count), 1, threads);
  auto next = [&, index = std::size_t{0}]() mutable -> std::optional<std::size_t> {
    throw_if_stopped(stop);
    return index < snapshots.count ? std::optional(index++) : std::nullopt;
  };
  OrderedPipeline<decltype(next), std::vector<ConditionedDepth>> pipeline(next, threads);
  fork_join(threads, [&](int) {
    pipeline.run([&](std::size_t index,
                     std::vector<ConditionedDepth>& depths) { depths = snapshots.make(index); },
                 [&](std::vector<ConditionedDepth>& depths) {
                   for (const ConditionedDepth& depth : depths) {
                     integrate(volume, depth, stop);
                   }
                   depths.clear();
                 });
  });
}

}  // namespace

void integrate(TsdfVolume& volume, const ConditionedSource& snapshots, int threads,
               const std::stop_token& stop) {
  if (volume.holds_all()) {
    integrate_in_parallel(volume, snapshots, threads, stop);
  } else {
    integrate_in_order(volume, snapshots, threads, stop);
  }
}

}  // namespace octurn
