#include "tsdf/node_classifier.hpp"

#include <cmath>

#include "parallel/vector_levels.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/sensor_from_voxel.hpp"

namespace octurn {
namespace {

/// The pixel that bounds a cube on one side, from -1024 to 16384. Projecting its edge at the near
/// and the far plane bounds it.
/// @param edge   in the sensor's frame, along X or Y; negated, like `focal`, for an upper bound
/// @param focal  length, pixels
int bounding_pixel(float edge, float near, float far, float focal, float centre) {
  const float at = smaller(edge / near, edge / far) * focal + centre;
  return nearest_pixel(smaller(larger(at, 0.5F - pixel_bias), 16384.0F));
}

}  // namespace

NodeClassifier::NodeClassifier(const VoxelGrid& grid, const ConditionedDepth& depth,
                               const SensorFromVoxel& sensor_from_voxel)
    : depth_(depth),
      sensor_from_voxel_(sensor_from_voxel),
      truncation_(static_cast<float>(grid.truncation())),
      camera_{.fx = static_cast<float>(depth.intrinsics().fx),
              .fy = static_cast<float>(depth.intrinsics().fy),
              .cx = static_cast<float>(depth.intrinsics().cx),
              .cy = static_cast<float>(depth.intrinsics().cy)} {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      half_extents_[i] += std::abs(sensor_from_voxel.step[axis][i]) / 2;
    }
  }
}

std::array<NodeClass, 8> NodeClassifier::classify_octants(const Index3& low, int voxels) const {
  Octants bounds;
  find_bounds(low, voxels, bounds);
  std::array<NodeClass, 8> classes{};
  for (std::size_t octant = 0; octant < 8; ++octant) {
    classes[octant] = classify(bounds, octant);
  }
  return classes;
}

/// Without branches, and by copies that no bound can alias, so that it is vectorised.
OCTURN_VECTOR_LEVELS
void NodeClassifier::find_bounds(const Index3& low, int voxels, Octants& bounds) const {
  const SensorFromVoxel sensor_from_voxel = sensor_from_voxel_;
  const auto side = static_cast<float>(voxels);
  const float half = 0.5F * side;
  const float half_x = half_extents_[0] * side;
  const float half_y = half_extents_[1] * side;
  const float half_z = half_extents_[2] * side;
  const auto [fx, fy, cx, cy] = camera_;
  for (int i = 0; i < 8; ++i) {
    const auto [x, y, z] =
        sensor_from_voxel(static_cast<float>(low.x + (i & 1) * voxels) + half,
                          static_cast<float>(low.y + (i >> 1 & 1) * voxels) + half,
                          static_cast<float>(low.z + (i >> 2) * voxels) + half);
    const auto octant = static_cast<std::size_t>(i);
    const float near = z - half_z;
    const float far = z + half_z;
    bounds.near[octant] = near;
    bounds.far[octant] = far;
    const float near_at = larger(near, min_z);
    const float far_at = larger(far, min_z);
    bounds.u0[octant] = bounding_pixel(x - half_x, near_at, far_at, fx, cx);
    bounds.u1[octant] = bounding_pixel(-x - half_x, near_at, far_at, -fx, cx);
    bounds.v0[octant] = bounding_pixel(y - half_y, near_at, far_at, fy, cy);
    bounds.v1[octant] = bounding_pixel(-y - half_y, near_at, far_at, -fy, cy);
  }
}

NodeClass NodeClassifier::classify(const Octants& bounds, std::size_t octant) const {
  const float near = bounds.near[octant];
  const float far = bounds.far[octant];
  if (far <= min_z) {
    return NodeClass::outside;
  }
  if (near <= min_z) {
    return NodeClass::near_surface;
  }
  const int u0 = bounds.u0[octant];
  const int u1 = bounds.u1[octant];
  const int v0 = bounds.v0[octant];
  const int v1 = bounds.v1[octant];
  if (u1 < 0 || v1 < 0 || u0 >= depth_.intrinsics().width || v0 >= depth_.intrinsics().height) {
    return NodeClass::outside;
  }
  const DepthPyramid::MinMax depth = depth_.min_max(u0, v0, u1, v1);
  if (near > depth.max_free + max_behind * truncation_) {
    return NodeClass::outside;
  }
  if (far < depth.min_free - free_margin * truncation_) {
    // Readings that make no surface, of the platform or the room, mostly lie behind those that do.
    return depth.max_free <= depth.max_surface ? NodeClass::free_to_surface : NodeClass::free;
  }
  const bool near_surface = near <= depth.max_surface + max_behind * truncation_ &&
                            far >= depth.min_surface - max_behind * truncation_;
  return near_surface ? NodeClass::near_surface : NodeClass::partial;
}

}  // namespace octurn
