#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "depth/back_project.hpp"
#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"

// The processing of a snapshot before triangulation, at the size of a Kinect v1's image.

namespace octurn {
namespace {

constexpr Intrinsics kinect{};

/// A ball of 0.1 m radius, 0.7 m away at the image's centre, in front of a wall at 1.1 m. One
/// column in sixteen has no readings.
DepthFrame ball_before_wall() {
  DepthFrame frame{.width = kinect.width, .height = kinect.height, .depth = {}};
  for (int v = 0; v < kinect.height; ++v) {
    for (int u = 0; u < kinect.width; ++u) {
      const double x = (u - kinect.cx) / kinect.fx;
      const double y = (v - kinect.cy) / kinect.fy;
      // The ray (x, y, 1) z meets the ball where |ray - (0, 0, 0.7)| = 0.1.
      const double a = x * x + y * y + 1.0;
      const double discriminant = 0.7 * 0.7 - a * (0.7 * 0.7 - 0.1 * 0.1);
      const double z = discriminant < 0.0 ? 1.1 : (0.7 - std::sqrt(discriminant)) / a;
      const bool valid = u % 16 != 0;
      frame.depth.push_back(static_cast<std::uint16_t>(valid ? z / kinect.depth_unit : 0.0));
    }
  }
  return frame;
}

void merge_ten_frames(benchmark::State& state) {
  std::array<DepthFrame, 10> frames;
  frames.fill(ball_before_wall());
  for (auto unused : state) {
    benchmark::DoNotOptimize(merge_frames(frames, DepthFilter::average));
  }
}
BENCHMARK(merge_ten_frames)->Unit(benchmark::kMillisecond);

void encode_png(benchmark::State& state) {
  const DepthFrame frame = ball_before_wall();
  for (auto unused : state) {
    benchmark::DoNotOptimize(encode_depth_png(frame));
  }
}
BENCHMARK(encode_png)->Unit(benchmark::kMillisecond);

void decode_png(benchmark::State& state) {
  const std::vector<std::byte> png = encode_depth_png(ball_before_wall());
  for (auto unused : state) {
    benchmark::DoNotOptimize(decode_depth_png("ball", png, kinect.width, kinect.height));
  }
}
BENCHMARK(decode_png)->Unit(benchmark::kMillisecond);

void world_points_and_clip(benchmark::State& state) {
  const Snapshot snapshot{.frame = ball_before_wall(),
                          .intrinsics = kinect,
                          .object_from_sensor = Eigen::Isometry3d::Identity()};
  for (auto unused : state) {
    PointGrid grid = world_points(snapshot);
    clip(grid, {.min = {-0.2, -0.2, 0.5}, .max = {0.2, 0.2, 0.9}});
    benchmark::DoNotOptimize(grid.points.data());
  }
}
BENCHMARK(world_points_and_clip)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace octurn
