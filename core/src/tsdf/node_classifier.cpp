#include "tsdf/node_classifier.hpp"

#include <cmath>

#include "depth/depth_limits.hpp"
#include "tsdf/integration_model.hpp"
#include "tsdf/pixels.hpp"

namespace octurn {

NodeClassifier::NodeClassifier(const VoxelGrid& grid, const ConditionedDepth& depth,
                               const SensorFromVoxel& sensor_from_voxel)
    : depth_(depth),
      sensor_from_voxel_(sensor_from_voxel),
      truncation_(static_cast<float>(grid.truncation())) {
  SensorFromVoxel::Vector half{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      half[i] += std::abs(sensor_from_voxel.step[axis][i]) / 2;
    }
  }
  half_depth_ = half[2];
  half_extents_ = {half[0], half[0], half[1], half[1]};
  const Intrinsics& intrinsics = depth.intrinsics();
  const auto fx = static_cast<float>(intrinsics.fx);
  const auto fy = static_cast<float>(intrinsics.fy);
  const auto cx = static_cast<float>(intrinsics.cx);
  const auto cy = static_cast<float>(intrinsics.cy);
  focal_ = {fx, -fx, fy, -fy};
  centre_ = {cx, cx, cy, cy};
}

NodeClass NodeClassifier::classify(const Index3& low, int voxels) const {
  constexpr auto min_z = static_cast<float>(nearest_z);
  const auto side = static_cast<float>(voxels);
  const float half = 0.5F * side;
  const SensorFromVoxel::Vector middle =
      sensor_from_voxel_(static_cast<float>(low.x) + half, static_cast<float>(low.y) + half,
                         static_cast<float>(low.z) + half);
  const float near = middle[2] - half_depth_ * side;
  const float far = middle[2] + half_depth_ * side;
  if (far <= min_z) {
    return NodeClass::outside;
  }
  if (near <= min_z) {
    return NodeClass::near_surface;
  }
  // Conservative pixel bounds of the node. Projecting each edge at the near and the far plane
  // bounds it; maxima are negated so that all four are minima.
  const Eigen::Array4f edge =
      Eigen::Array4f(middle[0], -middle[0], middle[1], -middle[1]) - half_extents_ * side;
  const Eigen::Array4f at = (edge / near).min(edge / far) * focal_ + centre_;
  const Eigen::Array4i pixels = nearest_pixels(at.max(0.5F - pixel_bias).min(16384.0F));
  const int u0 = pixels[0];
  const int u1 = pixels[1];
  const int v0 = pixels[2];
  const int v1 = pixels[3];
  if (u1 < 0 || v1 < 0 || u0 >= depth_.intrinsics().width || v0 >= depth_.intrinsics().height) {
    return NodeClass::outside;
  }
  const DepthPyramid::MinMax depth = depth_.min_max(u0, v0, u1, v1);
  if (near > depth.max_free + max_behind * truncation_) {
    return NodeClass::outside;
  }
  if (far < depth.min_free - free_margin * truncation_) {
    // What makes no surface, the platform or the room, mostly lies behind what does.
    return depth.max_free <= depth.max_surface ? NodeClass::free_to_surface : NodeClass::free;
  }
  const bool near_surface = near <= depth.max_surface + max_behind * truncation_ &&
                            far >= depth.min_surface - max_behind * truncation_;
  return near_surface ? NodeClass::near_surface : NodeClass::partial;
}

}  // namespace octurn
