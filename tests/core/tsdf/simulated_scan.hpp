#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "core/tsdf/rendered.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/stl.hpp"
#include "rig/nominal_pose.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulator_object.hpp"
#include "tsdf/solid_reconstructor.hpp"

namespace octurn {

/// An object on the simulated platform with its exact signed distance.
struct SimulatedObject {
  Shape distance = {};
  Eigen::AlignedBox3d bounds = {};  // metres; a little larger than the object
};

inline SimulatedObject robot() {
  return {.distance = simulator_object_distance, .bounds = simulator_object_bounds()};
}

/// A shape of `size` (metres) that stands `offset` from the platform's centre.
inline SimulatedObject standing(const Shape& shape, const Eigen::Vector3d& size,
                                const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(0.003);
  const Eigen::Vector3d low = offset - Eigen::Vector3d(size.x() / 2, size.y() / 2, 0);
  return {.distance = [=](const Eigen::Vector3d& p) { return shape(p - offset); },
          .bounds = {low - margin, low + size + margin}};
}

inline SimulatedObject standing_block(const Eigen::Vector3d& size,
                                      const Eigen::Vector3d& offset = Eigen::Vector3d::Zero()) {
  return standing(block(size), size, offset);
}

struct SimulatedTurn {
  int snapshots = 8;
  int frames = 10;       // at each stop, averaged
  double noise = 1.0;    // as a multiple of a real Kinect's
  double pattern = 0.0;  // fixed error, as a multiple of a real Kinect's
};

/// The snapshots of one turn of an object by a simulated Kinect v1.
inline std::vector<Snapshot> simulated_scan(const SimulatedObject& object,
                                            const SimulatedTurn& turn = {}) {
  constexpr double cell = 0.001;  // metres; the mesh of a 5 mm ball deviates by 0.05 mm
  SimulatedKinect kinect(Scene(surface_net(object.distance, object.bounds, cell)), 1, turn.noise,
                         turn.pattern);
  std::vector<Snapshot> snapshots;
  std::uint32_t number = 0;
  for (int i = 0; i < turn.snapshots; ++i) {
    const double angle = 2 * std::numbers::pi * i / turn.snapshots;
    std::vector<DepthFrame> frames;
    for (int frame = 0; frame < turn.frames; ++frame) {
      frames.push_back({.width = 640, .height = 480, .depth = {}});
      frames.back().depth.resize(std::size_t{640} * 480);
      kinect.expose(angle, number++, frames.back().depth);
    }
    snapshots.push_back(
        {.frame = merge_frames(frames, DepthFilter::average),
         .intrinsics = {},
         .object_from_sensor = object_from_sensor(nominal_platform_from_sensor(), angle)});
  }
  return snapshots;
}

/// A scan's default options.
inline ReconstructOptions scan_options(double leaf_size = 0.001) {
  return {.method = Method::solid,
          .leaf_size = leaf_size,
          .clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}}};
}

struct SolidModel {
  std::vector<Facet> facets = {};
  SurfaceCount count = {};
};

inline SolidModel solid_of(const ReconstructOptions& options,
                           const std::vector<Snapshot>& snapshots) {
  SolidReconstructor solid(options);
  const SnapshotSource source{.count = snapshots.size(),
                              .read = [&](std::size_t i) { return snapshots[i]; }};
  solid.add(source);
  SolidModel model;
  model.count = solid.surface(source, [&](std::span<const Facet> some) {
    model.facets.insert(model.facets.end(), some.begin(), some.end());
  });
  return model;
}

}  // namespace octurn
