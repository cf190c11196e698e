#include <benchmark/benchmark.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <stop_token>
#include <vector>

#include "bench/ball_snapshots.hpp"
#include "bennett/triangulate.hpp"
#include "bennett/voxelize_triangle.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/stl.hpp"
#include "support/temporary_folder.hpp"

// From points to a file, with eight snapshots of a ball at the size of a Kinect v1's image. The
// argument is the leaf size in micrometres.

namespace octurn {
namespace {

constexpr float threshold = 0.0001F;

PointGrid clipped_points(const Snapshot& snapshot) {
  PointGrid grid = world_points(snapshot);
  clip(grid, ball_clip);
  return grid;
}

ReconstructOptions options_for(const benchmark::State& state, int threads = 1) {
  return {.leaf_size = static_cast<double>(state.range(0)) / 1e6,
          .clip = ball_clip,
          .threads = threads};
}

/// A reconstruction with all snapshots added, before its surface is made.
std::unique_ptr<Reconstructor> reconstruction_for(const benchmark::State& state) {
  std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options_for(state));
  reconstruction->add(source());
  return reconstruction;
}

std::vector<Facet> facets_for(const benchmark::State& state) {
  std::vector<Facet> facets;
  reconstruction_for(state)->surface(source(), [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  return facets;
}

void triangulate_a_snapshot(benchmark::State& state) {
  const PointGrid grid = clipped_points(snapshots().front());
  std::int64_t triangles = 0;
  for (auto unused : state) {
    triangulate(grid, threshold,
                [&](const Eigen::Vector3f&, const Eigen::Vector3f&, const Eigen::Vector3f&) {
                  ++triangles;
                });
  }
  state.SetItemsProcessed(triangles);
}
BENCHMARK(triangulate_a_snapshot)->Unit(benchmark::kMillisecond);

void intersect_a_snapshot(benchmark::State& state) {
  std::vector<std::array<SnapPoint, 3>> triangles;
  const SnapGrid snap_grid(1.0);
  triangulate(clipped_points(snapshots().front()), threshold,
              [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
                triangles.push_back({*snap_grid.snap(a), *snap_grid.snap(b), *snap_grid.snap(c)});
              });
  const int levels = Octree::level_for(1.0, options_for(state).leaf_size);
  for (auto unused : state) {
    Octree octree(1.0, levels);
    for (const auto& [a, b, c] : triangles) {
      voxelize_triangle(octree, a, b, c);
    }
    benchmark::DoNotOptimize(octree.bytes());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(triangles.size()));
}
BENCHMARK(intersect_a_snapshot)->Arg(2000)->Arg(1000)->Arg(500)->Unit(benchmark::kMillisecond);

void count_the_surface(benchmark::State& state) {
  const std::unique_ptr<Reconstructor> reconstruction = reconstruction_for(state);
  std::uint64_t facets = 0;
  for (auto unused : state) {
    facets += reconstruction->count(source()).facets;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(facets));
}
BENCHMARK(count_the_surface)->Arg(1000)->Arg(500)->Unit(benchmark::kMillisecond);

void make_the_surface(benchmark::State& state) {
  const std::unique_ptr<Reconstructor> reconstruction = reconstruction_for(state);
  std::uint64_t facets = 0;
  for (auto unused : state) {
    facets += reconstruction->surface(source(), [](std::span<const Facet>) {}).facets;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(facets));
}
BENCHMARK(make_the_surface)->Arg(2000)->Arg(1000)->Arg(500)->Unit(benchmark::kMillisecond);

void check_the_mesh(benchmark::State& state) {
  const std::vector<Facet> facets = facets_for(state);
  for (auto unused : state) {
    MeshCheck check;
    check.add(facets);
    benchmark::DoNotOptimize(check.closed());
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(facets.size()));
}
BENCHMARK(check_the_mesh)->Arg(1000)->Unit(benchmark::kMillisecond);

void write_the_file(benchmark::State& state) {
  const std::vector<Facet> facets = facets_for(state);
  const TemporaryFolder folder;
  for (auto unused : state) {
    StlFile file(folder.path() / "Scan.stl");
    file.write(facets);
    file.commit();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(facets.size()));
}
BENCHMARK(write_the_file)->Arg(1000)->Unit(benchmark::kMillisecond);

/// From snapshots in memory to facets that are discarded. The second argument is the thread count.
void reconstruct_the_whole(benchmark::State& state) {
  std::uint64_t facets = 0;
  for (auto unused : state) {
    const std::unique_ptr<Reconstructor> reconstruction =
        make_reconstructor(options_for(state, static_cast<int>(state.range(1))));
    reconstruction->add(source());
    facets += reconstruction->surface(source(), [](std::span<const Facet>) {}).facets;
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(facets));
}
BENCHMARK(reconstruct_the_whole)
    ->ArgsProduct({{2000, 1000, 500, 250}, {1, 2}})
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace octurn
