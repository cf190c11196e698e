#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <vector>

#include "core/mesh/surface.hpp"
#include "octurn/snapshot.hpp"
#include "tsdf/solid_reconstructor.hpp"

// For any depths, the solid model is one closed, manifold part.

namespace {

void require(bool promise) {
  if (!promise) {
    std::abort();
  }
}

constexpr int width = 24;
constexpr int height = 18;

/// A snapshot of a sensor that looks down at the platform. Each byte is a sample at 0.55 to 0.70 m.
octurn::Snapshot snapshot_of(const std::uint8_t* data, double angle) {
  octurn::Snapshot snapshot;
  snapshot.intrinsics = {.width = width,
                         .height = height,
                         .fx = 200,
                         .fy = 200,
                         .cx = width / 2.0,
                         .cy = height / 2.0,
                         .depth_unit = 0.0001};
  snapshot.frame = {.width = width, .height = height, .depth = {}};
  for (int i = 0; i < width * height; ++i) {
    snapshot.frame.depth.push_back(data[i] == 0 ? std::uint16_t{0}
                                                : static_cast<std::uint16_t>(5500 + data[i] * 6));
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::AngleAxisd(angle / 3, Eigen::Vector3d::UnitX()) *
                  Eigen::Matrix3d(Eigen::Vector3d(1, -1, -1).asDiagonal());
  pose.translation() = Eigen::Vector3d(0, 0, 0.7);
  snapshot.object_from_sensor = octurn::object_from_sensor(pose, angle);
  return snapshot;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t samples = width * height;
  if (size < 1 + samples) {
    return 0;
  }
  octurn::ReconstructOptions options{
      .method = octurn::Method::solid,
      .leaf_size = 0.002,
      .clip = {.min = {-0.05, -0.05, 0.002}, .max = {0.05, 0.05, 0.1}}};
  options.target_error = (data[0] & 3) * 0.0005;
  octurn::SolidReconstructor solid(options);
  const std::size_t count = std::min<std::size_t>((size - 1) / samples, 6);
  for (std::size_t i = 0; i < count; ++i) {
    solid.add(snapshot_of(data + 1 + i * samples, static_cast<double>(i)));
  }
  std::vector<octurn::Facet> facets;
  const octurn::SurfaceCount surface = solid.surface({}, [&](std::span<const octurn::Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  require(surface.facets == facets.size());
  if (!facets.empty()) {
    require(surface.parts == 1);
    require(octurn::topology_of(facets).manifold);
  }
  return 0;
}
