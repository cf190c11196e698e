#pragma once

#include <array>
#include <cstddef>

#include "tsdf/sensor_from_voxel.hpp"

namespace octurn {

/// Class of a cube of voxels in one snapshot.
enum class NodeClass {
  outside,          ///< not seen: outside the view, or behind all surfaces
  free,             ///< all rays passed through
  free_to_surface,  ///< all rays passed through, and ended on a surface
  partial,          ///< partly free, without a surface near
  near_surface,     ///< a surface may lie within the truncation
};

/// Classifies cubes of voxels by conservative bounds: those of their pixels, and the minimum and
/// maximum depth over these.
class NodeClassifier {
 public:
  /// @param depth  must outlive this
  NodeClassifier(const VoxelGrid& grid, const ConditionedDepth& depth,
                 const SensorFromVoxel& sensor_from_voxel);

  /// The classes of a cube's eight octants. Bits 0, 1 and 2 of an index are set for the upper half
  /// along x, y and z.
  /// @param low     the lowest octant's lowest voxel, counted from the grid's lowest corner
  /// @param voxels  along an octant's side
  std::array<NodeClass, 8> classify_octants(const Index3& low, int voxels) const;

  /// The same of one cube.
  NodeClass classify(const Index3& low, int voxels) const {
    return classify_octants(low, voxels)[0];
  }

 private:
  /// A pinhole camera in single precision.
  struct Camera {
    float fx;
    float fy;
    float cx;
    float cy;
  };

  /// Conservative bounds of eight cubes, as a structure of arrays.
  struct Octants {
    template <typename Value>
    using Each = std::array<Value, 8>;

    Each<float> near;  // along the sensor's Z, metres
    Each<float> far;
    Each<int> u0;  // pixels
    Each<int> u1;
    Each<int> v0;
    Each<int> v1;
  };

  void find_bounds(const Index3& low, int voxels, Octants& bounds) const;
  NodeClass classify(const Octants& bounds, std::size_t octant) const;

  const ConditionedDepth& depth_;
  SensorFromVoxel sensor_from_voxel_;
  float truncation_;
  Camera camera_;
  std::array<float, 3> half_extents_ = {};  // of a voxel along the sensor's axes
};

}  // namespace octurn
