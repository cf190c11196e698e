#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

#include "octurn/reconstruct.hpp"
#include "tsdf/hole_filled_sdf.hpp"
#include "voxel/index3.hpp"

namespace octurn {

/// A signed distance field with the cuts and erased balls of a person's edits, as marching cubes
/// read it.
///
/// Each edge of the surface is crossed by the object's surface, by that of an edit, or by both;
/// then the crossing nearest to the inside counts. Sections are therefore flat up to the object's
/// surface: the maximum of both distances would round their rims, and distances deep inside are no
/// measure.
class EditedSdf {
 public:
  static constexpr bool has_platform = HoleFilledSdf::has_platform;

  /// @param sdf, edits  must outlive this
  EditedSdf(const HoleFilledSdf& sdf, const ModelEdits& edits) : sdf_(sdf), edits_(edits) {}

  double voxel_side() const { return sdf_.voxel_side(); }
  double centre(int voxel, std::size_t axis) const { return sdf_.centre(voxel, axis); }
  float half_voxel() const { return sdf_.half_voxel(); }

  /// Whether the centre of a voxel is cut off or erased.
  bool is_removed(const Index3& voxel) const {
    const Eigen::Vector3d point = to_point(voxel);
    const auto removes = [&](const auto& edit) { return depth(edit, point) >= 0; };
    return std::ranges::any_of(edits_.cuts, removes) || std::ranges::any_of(edits_.erased, removes);
  }

  /// The values at both ends of an edge of the surface. @param inside  the end in the object
  std::pair<HoleFilledSdf::Value, HoleFilledSdf::Value> edge(const Index3& inside,
                                                             const Index3& outside) const {
    std::pair nearest(sdf_.at(inside), sdf_.at(outside));
    const std::array points{to_point(inside), to_point(outside)};
    float crossing = nearest.first.distance < 0 && nearest.second.distance > 0
                         ? share(nearest.first.distance, nearest.second.distance)
                         : std::numeric_limits<float>::max();
    const auto cross = [&](const auto& edit) {
      const float outer = ticks(depth(edit, points[1]));
      const float inner = std::min(ticks(depth(edit, points[0])), -1.0F);
      if (outer >= 0 && share(inner, std::max(outer, 1.0F)) < crossing) {
        nearest = {{inner, false}, {std::max(outer, 1.0F), false}};
        crossing = share(inner, std::max(outer, 1.0F));
      }
    };
    std::ranges::for_each(edits_.cuts, cross);
    std::ranges::for_each(edits_.erased, cross);
    return nearest;
  }

 private:
  /// Where the surface crosses an edge, from 0 at its inner to 1 at its outer end.
  /// @param inner, outer  distances at these ends, negative and positive
  static float share(float inner, float outer) { return inner / (inner - outer); }

  /// Metres behind the surface of an edit, positive in what it removes.
  static double depth(const CutPlane& cut, const Eigen::Vector3d& point) {
    return cut.normal.dot(point) - cut.distance;
  }
  static double depth(const ErasedBall& ball, const Eigen::Vector3d& point) {
    return ball.radius - (point - ball.centre).norm();
  }

  Eigen::Vector3d to_point(const Index3& voxel) const {
    return {centre(voxel.x, 0), centre(voxel.y, 1), centre(voxel.z, 2)};
  }

  float ticks(double metres) const {
    return static_cast<float>(metres / sdf_.grid().truncation() * VoxelGrid::ticks);
  }

  const HoleFilledSdf& sdf_;
  const ModelEdits& edits_;
};

}  // namespace octurn
