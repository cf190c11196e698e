#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "parallel/thread_team.hpp"
#include "tsdf/compact_tsdf.hpp"
#include "tsdf/laplace_fill.hpp"
#include "tsdf/voxel_grid.hpp"
#include "voxel/voxel_mask.hpp"

namespace octurn {

/// A signed distance field that is defined everywhere: the unobserved voxels of a TSDF are filled
/// smoothly.
///
/// Laplace's equation fills the distances of blocks of voxels (`laplace_fill`), which are
/// interpolated trilinearly at unknown and occluded voxels. Layers below the base layer repeat it,
/// and the field is cut at the platform's plane, so that the model has a flat base. With several
/// poses, voxels right above a platform that no pose observed repeat the value above them.
class HoleFilledSdf {
 public:
  /// @param known       must outlive this
  /// @param base_layer  the lowest layer of voxels whose samples count
  /// @param max_bulge   metres, as of `limit_bulges`; nothing: no limit
  /// @throws Stopped
  HoleFilledSdf(const CompactTsdf& known, int base_layer, const std::stop_token& stop = {},
                ThreadTeam& team = ThreadTeam::alone(), std::optional<double> max_bulge = {});

  /// For several poses: all layers count, and the field is cut at each pose's platform where the
  /// object's foot was not observed.
  /// @param platforms  of the poses, at least one
  HoleFilledSdf(const CompactTsdf& known, std::vector<PlatformCut> platforms,
                const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone(),
                std::optional<double> max_bulge = {});

  const VoxelGrid& grid() const { return known_.grid(); }

  /// Whether the plane between the voxels -1 and 0 along z is the platform's.
  static constexpr bool has_platform = true;

  /// The half-open box of voxels that encloses the object: all bricks, and one around them.
  const Index3& low() const { return low_; }
  const Index3& end() const { return end_; }

  double voxel_side() const { return grid().voxel_side(); }
  double centre(int voxel, std::size_t axis) const { return grid().centre(voxel, axis); }

  /// Half a voxel's side, ticks.
  float half_voxel() const {
    return static_cast<float>(grid().voxel_side() / 2 / grid().truncation() * VoxelGrid::ticks);
  }

  struct Value {
    float distance = 0;     // ticks, positive outside
    bool observed = false;  // or filled
  };

  /// The value at the centre of a voxel of that box, or of one below it.
  Value at(const Index3& voxel) const;

  /// Whether a ray passed through a voxel of that box, or ended right behind it.
  bool is_seen_empty(const Index3& voxel) const;

  /// The voxels of that box with a negative distance, except those on its sides and top.
  /// @throws Stopped
  VoxelMask inside(const std::stop_token& stop = {}, ThreadTeam& team = ThreadTeam::alone()) const;

 private:
  /// Two neighbouring blocks on an axis, and the second one's weight.
  struct LerpWeight {
    int first = 0;
    float part = 0;
  };
  enum class Side { inside, outside, both };
  enum class Place { above, near, below };  // the platforms of several poses, or one of them

  void fill(std::optional<double> max_bulge, const std::stop_token& stop, ThreadTeam& team);
  std::vector<LerpWeight> lerp_weights(int voxels, int blocks) const;
  float trilinear(const LerpWeight& x, const LerpWeight& y, const LerpWeight& z) const;
  float filled_at(const Index3& voxel) const;
  VoxelState state_at(const Index3& voxel, const CompactBrick* brick) const;
  const CompactBrick* brick_at(const Index3& voxel) const;
  Value sample(const Index3& voxel) const;
  Value fill_foot(const Index3& voxel, Value value) const;
  Value cut_by_platforms(const Index3& voxel, Value value) const;
  float ticks(double metres) const;
  Place to_place(const Index3& low, const Index3& size) const;
  Side to_side(const Index3& brick) const;
  std::uint64_t inside_bits(const Index3& first) const;
  void add_inside(const Index3& brick, VoxelMask& mask) const;

  const CompactTsdf& known_;
  int base_layer_;
  std::vector<PlatformCut> platforms_ = {};  // of several poses; empty for one
  Index3 low_ = {};
  Index3 end_ = {};
  Index3 low_brick_ = {};
  PartialGrid blocks_ = {};                                   // distances in ticks
  std::array<std::vector<LerpWeight>, 3> lerp_weights_ = {};  // of the box's voxels on each axis
};

}  // namespace octurn
