#include <benchmark/benchmark.h>

#include <cstdint>
#include <span>

#include "bench/ball_snapshots.hpp"
#include "tsdf/integrate.hpp"
#include "tsdf/solid_reconstructor.hpp"
#include "voxel/octree.hpp"

// The solid method, with eight snapshots of a ball at the size of a Kinect v1's image. The argument
// is the leaf size in micrometres.

namespace octurn {
namespace {

ReconstructOptions options_for(const benchmark::State& state) {
  return {.method = Method::solid,
          .leaf_size = static_cast<double>(state.range(0)) / 1e6,
          .clip = ball_clip};
}

void condition_a_snapshot(benchmark::State& state) {
  for (auto unused : state) {
    const ConditionedDepth depth(snapshots().front(), ball_clip);
    benchmark::DoNotOptimize(depth.at(320, 240));
  }
}
BENCHMARK(condition_a_snapshot)->Unit(benchmark::kMillisecond);

void integrate_a_snapshot(benchmark::State& state) {
  const ConditionedDepth depth(snapshots().front(), ball_clip);
  const double leaf_size = options_for(state).leaf_size;
  const int levels = Octree::level_for(1.0, leaf_size);
  // The snapshot was integrated into this volume before, so that no brick is new.
  TsdfVolume volume(VoxelGrid(1.0, levels, ball_clip, 0.0035));
  integrate(volume, depth);
  for (auto unused : state) {
    integrate(volume, depth);
    benchmark::DoNotOptimize(volume.bytes());
  }
}
BENCHMARK(integrate_a_snapshot)->Arg(2000)->Arg(1000)->Arg(500)->Unit(benchmark::kMillisecond);

void make_the_surface(benchmark::State& state, double target_error) {
  ReconstructOptions options = options_for(state);
  options.target_error = target_error;
  SolidReconstructor solid(options);
  solid.add(source());
  std::uint64_t facets = 0;
  for (auto unused : state) {
    facets += solid.surface(source(), [](std::span<const Facet>) {}).facets;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(facets));
}
void make_the_whole_surface(benchmark::State& state) { make_the_surface(state, 0); }
void make_a_surface_of_fewer_triangles(benchmark::State& state) {
  make_the_surface(state, ReconstructOptions().target_error);
}
BENCHMARK(make_the_whole_surface)->Arg(2000)->Arg(1000)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(make_a_surface_of_fewer_triangles)
    ->Arg(2000)
    ->Arg(1000)
    ->Arg(500)
    ->Unit(benchmark::kMillisecond);

/// From snapshots in memory to facets that are discarded. The second argument is the thread count.
void make_the_whole_solid(benchmark::State& state) {
  std::uint64_t facets = 0;
  for (auto unused : state) {
    ReconstructOptions options = options_for(state);
    options.threads = static_cast<int>(state.range(1));
    SolidReconstructor solid(options);
    solid.add(source());
    facets += solid.surface(source(), [](std::span<const Facet>) {}).facets;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(facets));
}
BENCHMARK(make_the_whole_solid)
    ->ArgsProduct({{2000, 1000, 500}, {1, 2}})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace octurn
