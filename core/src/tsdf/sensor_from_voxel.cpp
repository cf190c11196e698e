#include "tsdf/sensor_from_voxel.hpp"

namespace octurn {

SensorFromVoxel::SensorFromVoxel(const VoxelGrid& grid, const ConditionedDepth& depth) {
  const auto voxel_side = static_cast<float>(grid.voxel_side());
  const Eigen::Matrix3f rotation = depth.sensor_from_object().linear().cast<float>();
  const Eigen::Vector3f corner = (depth.sensor_from_object() * grid.box().min).cast<float>();
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    origin[i] = corner[axis];
    for (std::size_t j = 0; j < 3; ++j) {
      step[j][i] = rotation(axis, static_cast<Eigen::Index>(j)) * voxel_side;
    }
  }
}

}  // namespace octurn
