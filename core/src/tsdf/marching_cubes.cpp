#include "tsdf/marching_cubes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "tsdf/marching_cubes_cases.hpp"

namespace octurn {
namespace {

/// Slicers meld vertices that are closer than this: CuraEngine below 0.030 mm.
constexpr double min_gap_mm = 0.036;

/// On edges of the few cases whose triangles could intersect, vertices keep this share of the edge
/// from its ends.
constexpr float ambiguous_margin = 0.3F;

/// A layer of cubes between two layers of voxels.
struct CubeLayer {
  struct Cube {
    int x = 0;
    int y = 0;
    std::uint8_t pattern = 0;
  };
  std::vector<Cube> mixed = {};
  std::vector<std::uint8_t> ambiguous = {};  // 1 for each cube of such a case; empty: there is none
};

/// The centres of a grid's voxels, all at one distance from the surface.
class MidpointField {
 public:
  static constexpr bool has_platform = true;

  MidpointField(double root_side, double voxel_side)
      : root_side_(root_side), voxel_side_(voxel_side) {}

  double voxel_side() const { return voxel_side_; }
  double centre(int voxel, std::size_t axis) const {
    return (voxel + 0.5) * voxel_side_ - (axis < 2 ? root_side_ / 2 : 0.0);
  }
  float half_voxel() const { return 1; }
  HoleFilledSdf::Value at(const Index3& /*voxel*/) const {
    return {.distance = 0, .observed = true};
  }

 private:
  double root_side_;
  double voxel_side_;
};

constexpr CubeRange all_cubes{
    .low = {-1, -1, -1},
    .end = {std::numeric_limits<int>::max(), std::numeric_limits<int>::max(),
            std::numeric_limits<int>::max()}};

/// @tparam Field  `HoleFilledSdf`, `MidpointField` or `ShellField`
template <typename Field>
class MarchingCubes {
 public:
  MarchingCubes(const VoxelMask& inside, const Field& field, const MeshSink& sink,
                const CubeRange& range = all_cubes)
      : inside_(inside),
        field_(field),
        sink_(sink),
        range_(range),
        width_(static_cast<std::size_t>(inside.size().x)),
        empty_row_(inside.words_per_row()) {
    const std::size_t layer = width_ * static_cast<std::size_t>(inside.size().y);
    for (auto& indices : indices_) {
      indices.resize(layer);
    }
    end_margin_ = static_cast<float>(
        std::min(min_gap_mm / (std::numbers::sqrt2 * mm_from_metres(field.voxel_side())), 0.3));
  }

  void run(const std::stop_token& stop) {
    CubeLayer below;
    CubeLayer here = cubes_at(-1);
    for (int z = -1; z < inside_.size().z; ++z) {
      throw_if_stopped(stop);
      CubeLayer above = cubes_at(z + 1);
      vertices_.clear();
      triangles_.clear();
      for (const CubeLayer::Cube& cube : here.mixed) {
        if (is_drawn({cube.x, cube.y, z})) {
          add_cube(cube, z, below, here, above);
        }
      }
      if (!triangles_.empty()) {
        sink_({.vertices = vertices_, .triangles = triangles_});
      }
      // The edges along x and y above these cubes are those below the next.
      std::swap(indices_[0], indices_[3]);
      std::swap(indices_[1], indices_[4]);
      for (const std::size_t used : {2U, 3U, 4U}) {
        std::ranges::fill(indices_[used], 0U);
      }
      below = std::move(here);
      here = std::move(above);
    }
  }

 private:
  std::span<const std::uint64_t> row(int y, int z) const {
    return z >= 0 && z < inside_.size().z ? inside_.row(y, z) : std::span(empty_row_);
  }

  bool is_drawn(const Index3& cube) const {
    return cube.x >= range_.low.x && cube.x < range_.end.x && cube.y >= range_.low.y &&
           cube.y < range_.end.y && cube.z >= range_.low.z && cube.z < range_.end.z;
  }

  /// Whether cubes that are not drawn share the vertex on the edge from `voxel` along `axis`.
  bool is_shared(const Index3& voxel, std::size_t axis) const {
    const auto on_side = [&](std::size_t other, int at, int low, int end) {
      return axis != other && (at == low || at == end);
    };
    return on_side(0, voxel.x, range_.low.x, range_.end.x) ||
           on_side(1, voxel.y, range_.low.y, range_.end.y) ||
           on_side(2, voxel.z, range_.low.z, range_.end.z);
  }

  CubeLayer cubes_at(int z) const {
    CubeLayer layer;
    for (int y = 0; y + 1 < inside_.size().y; ++y) {
      const std::array rows{row(y, z), row(y + 1, z), row(y, z + 1), row(y + 1, z + 1)};
      for (std::size_t word = 0; word < empty_row_.size(); ++word) {
        add_mixed(rows, word, y, layer);
      }
    }
    return layer;
  }

  /// Adds those of 64 cubes along x that the surface crosses.
  /// @param rows  of voxels that they lie between
  void add_mixed(const std::array<std::span<const std::uint64_t>, 4>& rows, std::size_t word, int y,
                 CubeLayer& layer) const {
    std::array<std::uint64_t, 8> corners{};
    std::uint64_t any = 0;
    std::uint64_t all = ~std::uint64_t{0};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint64_t next = word + 1 < rows[i].size() ? rows[i][word + 1] : 0;
      corners[2 * i] = rows[i][word];
      corners[2 * i + 1] = rows[i][word] >> 1 | next << 63;
      any |= corners[2 * i] | corners[2 * i + 1];
      all &= corners[2 * i] & corners[2 * i + 1];
    }
    for (std::uint64_t mixed = any & ~all; mixed != 0; mixed &= mixed - 1) {
      const int bit = std::countr_zero(mixed);
      std::size_t pattern = 0;
      for (std::size_t corner = 0; corner < 8; ++corner) {
        pattern |= (corners[corner] >> bit & 1) << corner;
      }
      const int x = static_cast<int>(word) * 64 + bit;
      layer.mixed.push_back({x, y, static_cast<std::uint8_t>(pattern)});
      if (is_self_intersecting_case(pattern)) {
        layer.ambiguous.resize(indices_[0].size());
        layer.ambiguous[at(x, y)] = 1;
      }
    }
  }

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x);
  }

  void add_cube(const CubeLayer::Cube& cube, int z, const CubeLayer& below, const CubeLayer& here,
                const CubeLayer& above) {
    const CubeSurface& surface = marching_cubes_cases[cube.pattern];
    for (std::size_t i = 0; i < surface.count; ++i) {
      MeshTriangle triangle{};
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const CubeEdge edge = surface.triangles[i][corner];
        const std::size_t axis = edge / 4U;
        const Index3 voxel = find_start(edge, {cube.x, cube.y, z});
        const bool is_above = axis < 2 && voxel.z > z;
        std::uint32_t& index = indices_[axis + (is_above ? 3 : 0)][at(voxel.x, voxel.y)];
        if (index == 0) {
          index = ++vertex_count_;
          vertices_.push_back(
              vertex(voxel, axis, is_above || axis == 2 ? here : below, is_above ? above : here));
        }
        triangle[corner] = index - 1;
      }
      triangles_.push_back(triangle);
    }
  }

  /// The voxel that an edge of a cube begins at.
  static Index3 find_start(CubeEdge edge, Index3 cube) {
    const int u = edge % 2;
    const int v = edge / 2 % 2;
    switch (edge / 4) {
      case 0:
        return {cube.x, cube.y + u, cube.z + v};
      case 1:
        return {cube.x + v, cube.y, cube.z + u};
      default:
        return {cube.x + u, cube.y + v, cube.z};
    }
  }

  /// @param below, above  the layers of cubes that meet in the edge from `voxel` along `axis`
  MeshVertex vertex(const Index3& voxel, std::size_t axis, const CubeLayer& below,
                    const CubeLayer& above) const {
    const Index3& low = inside_.low();
    Index3 first{voxel.x + low.x, voxel.y + low.y, voxel.z + low.z};
    Index3 second = first;
    (axis == 0 ? second.x : axis == 1 ? second.y : second.z) += 1;
    const bool first_inside = inside_.contains(voxel.x, voxel.y, voxel.z);
    const auto a = field_.at(first);
    const auto b = field_.at(second);
    const float from_first = magnitude(a.distance, first_inside);
    const float from_second = magnitude(b.distance, !first_inside);
    float fraction = from_first / (from_first + from_second);
    fraction = std::clamp(fraction, end_margin_, 1 - end_margin_);
    if (Field::has_platform && axis == 2 && first.z == -1) {
      fraction = 0.5F;  // the platform's plane
    } else if (touches_ambiguous_case(voxel, axis, below, above)) {
      fraction = std::clamp(fraction, ambiguous_margin, 1 - ambiguous_margin);
    }
    MeshVertex vertex{
        .position = {}, .observed = a.observed && b.observed, .fixed = is_shared(voxel, axis)};
    const std::array<int, 3> position{first.x, first.y, first.z};
    for (std::size_t i = 0; i < 3; ++i) {
      const double step = i == axis ? static_cast<double>(fraction) : 0.0;
      vertex.position[i] = static_cast<float>(
          mm_from_metres(field_.centre(position[i], i) + step * field_.voxel_side()));
    }
    return vertex;
  }

  /// A voxel's distance to the surface, ticks; half a voxel where the field's sign contradicts the
  /// mask.
  float magnitude(float distance, bool is_inside) const {
    const float outward = is_inside ? -distance : distance;
    return outward > 0 ? outward : field_.half_voxel();
  }

  bool touches_ambiguous_case(const Index3& voxel, std::size_t axis, const CubeLayer& below,
                              const CubeLayer& above) const {
    const auto is_ambiguous = [&](const CubeLayer& layer, int x, int y) {
      return !layer.ambiguous.empty() && x >= 0 && y >= 0 && layer.ambiguous[at(x, y)] != 0;
    };
    const int x = voxel.x - (axis == 0 ? 0 : 1);
    const int y = voxel.y - (axis == 1 ? 0 : 1);
    return is_ambiguous(below, voxel.x, voxel.y) || is_ambiguous(below, x, y) ||
           is_ambiguous(above, voxel.x, voxel.y) || is_ambiguous(above, x, y) ||
           (axis == 2 && (is_ambiguous(below, x, voxel.y) || is_ambiguous(below, voxel.x, y)));
  }

  const VoxelMask& inside_;
  const Field& field_;
  const MeshSink& sink_;
  CubeRange range_;
  std::size_t width_;
  std::vector<std::uint64_t> empty_row_;
  float end_margin_ = 0;
  // Vertex indices plus 1 (0: none yet) by the voxel that an edge begins at: along x and y below
  // the cubes, along z, along x and y above.
  std::array<std::vector<std::uint32_t>, 5> indices_ = {};
  std::uint32_t vertex_count_ = 0;
  std::vector<MeshVertex> vertices_ = {};
  std::vector<MeshTriangle> triangles_ = {};
};

}  // namespace

void marching_cubes(const VoxelMask& inside, const HoleFilledSdf& sdf, const MeshSink& sink,
                    const std::stop_token& stop) {
  MarchingCubes(inside, sdf, sink).run(stop);
}

void marching_cubes(const VoxelMask& inside, const ShellField& shell, const CubeRange& range,
                    const MeshSink& sink, const std::stop_token& stop) {
  MarchingCubes(inside, shell, sink, range).run(stop);
}

void marching_cubes(const VoxelMask& inside, double root_side, double voxel_side,
                    const MeshSink& sink, const std::stop_token& stop) {
  const MidpointField midpoints(root_side, voxel_side);
  MarchingCubes(inside, midpoints, sink).run(stop);
}

}  // namespace octurn
