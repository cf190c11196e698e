#include "tsdf/marching_cubes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "tsdf/marching_cubes_cases.hpp"

namespace octurn {
namespace {

/// Vertices closer than this are melded by slicers: CuraEngine's limit is 0.030.
constexpr double least_gap_mm = 0.036;

/// Vertices beyond these parts of an edge could cut the surface, in the few patterns that can.
constexpr float least_part_of_cutting = 0.3F;

/// A layer of cubes between two layers of leaves.
struct CubeLayer {
  struct Cube {
    int x = 0;
    int y = 0;
    std::uint8_t pattern = 0;
  };
  std::vector<Cube> mixed = {};
  std::vector<std::uint8_t> cutting = {};  // of each cube of the layer; empty if there is none
};

class MarchingCubes {
 public:
  MarchingCubes(const VoxelMask& inside, const HoleFilledSdf& field, const MeshSink& sink)
      : inside_(inside),
        field_(field),
        sink_(sink),
        width_(static_cast<std::size_t>(inside.size().x)),
        empty_row_(inside.words_per_row()) {
    const std::size_t layer = width_ * static_cast<std::size_t>(inside.size().y);
    for (auto& names : names_) {
      names.resize(layer);
    }
    least_part_ = static_cast<float>(
        std::min(least_gap_mm / (std::numbers::sqrt2 * mm_from_metres(field.leaf_side())), 0.3));
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
        add_cube(cube, z, below, here, above);
      }
      if (!triangles_.empty()) {
        sink_({.vertices = vertices_, .triangles = triangles_});
      }
      // The edges along x and y above these cubes are those below the next.
      std::swap(names_[0], names_[3]);
      std::swap(names_[1], names_[4]);
      for (const std::size_t used : {2U, 3U, 4U}) {
        std::ranges::fill(names_[used], 0U);
      }
      below = std::move(here);
      here = std::move(above);
    }
  }

 private:
  std::span<const std::uint64_t> row(int y, int z) const {
    return z >= 0 && z < inside_.size().z ? inside_.row(y, z) : std::span(empty_row_);
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
  /// @param rows  of leaves that they lie between
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
        layer.cutting.resize(names_[0].size());
        layer.cutting[at(x, y)] = 1;
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
        const Index3 leaf = start_of(edge, {cube.x, cube.y, z});
        const bool is_above = axis < 2 && leaf.z > z;
        std::uint32_t& name = names_[axis + (is_above ? 3 : 0)][at(leaf.x, leaf.y)];
        if (name == 0) {
          name = ++last_name_;
          vertices_.push_back(
              vertex(leaf, axis, is_above || axis == 2 ? here : below, is_above ? above : here));
        }
        triangle[corner] = name - 1;
      }
      triangles_.push_back(triangle);
    }
  }

  /// The leaf that an edge of a cube begins at.
  static Index3 start_of(CubeEdge edge, Index3 cube) {
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

  /// @param below, above  the layers of cubes that meet in the edge from `leaf` along `axis`
  MeshVertex vertex(const Index3& leaf, std::size_t axis, const CubeLayer& below,
                    const CubeLayer& above) const {
    const Index3& low = inside_.low();
    Index3 first{leaf.x + low.x, leaf.y + low.y, leaf.z + low.z};
    Index3 second = first;
    (axis == 0 ? second.x : axis == 1 ? second.y : second.z) += 1;
    const bool first_inside = inside_.contains(leaf.x, leaf.y, leaf.z);
    const HoleFilledSdf::Value a = field_.at(first);
    const HoleFilledSdf::Value b = field_.at(second);
    const float from_first = magnitude(a.distance, first_inside);
    const float from_second = magnitude(b.distance, !first_inside);
    float part = from_first / (from_first + from_second);
    part = std::clamp(part, least_part_, 1 - least_part_);
    if (axis == 2 && first.z == -1) {
      part = 0.5F;  // the platform's plane
    } else if (touches_ambiguous_case(leaf, axis, below, above)) {
      part = std::clamp(part, least_part_of_cutting, 1 - least_part_of_cutting);
    }
    MeshVertex vertex{.position = {}, .observed = a.seen && b.seen};
    const std::array<int, 3> cell{first.x, first.y, first.z};
    for (std::size_t i = 0; i < 3; ++i) {
      const double step = i == axis ? static_cast<double>(part) : 0.0;
      vertex.position[i] =
          static_cast<float>(mm_from_metres(field_.centre(cell[i], i) + step * field_.leaf_side()));
    }
    return vertex;
  }

  /// How far a leaf is from the surface, in ticks; half a leaf where the field has another sign
  /// than the set.
  float magnitude(float distance, bool is_inside) const {
    const float outward = is_inside ? -distance : distance;
    return outward > 0 ? outward : field_.half_leaf();
  }

  bool touches_ambiguous_case(const Index3& leaf, std::size_t axis, const CubeLayer& below,
                              const CubeLayer& above) const {
    const auto is_cutting = [&](const CubeLayer& layer, int x, int y) {
      return !layer.cutting.empty() && x >= 0 && y >= 0 && layer.cutting[at(x, y)] != 0;
    };
    const int x = leaf.x - (axis == 0 ? 0 : 1);
    const int y = leaf.y - (axis == 1 ? 0 : 1);
    return is_cutting(below, leaf.x, leaf.y) || is_cutting(below, x, y) ||
           is_cutting(above, leaf.x, leaf.y) || is_cutting(above, x, y) ||
           (axis == 2 && (is_cutting(below, x, leaf.y) || is_cutting(below, leaf.x, y)));
  }

  const VoxelMask& inside_;
  const HoleFilledSdf& field_;
  const MeshSink& sink_;
  std::size_t width_;
  std::vector<std::uint64_t> empty_row_;
  float least_part_ = 0;
  // Numbers of vertices, from 1, by the leaf that an edge begins at: along x and y below the cubes,
  // along z, along x and y above.
  std::array<std::vector<std::uint32_t>, 5> names_ = {};
  std::uint32_t last_name_ = 0;
  std::vector<MeshVertex> vertices_ = {};
  std::vector<MeshTriangle> triangles_ = {};
};

}  // namespace

void marching_cubes(const VoxelMask& inside, const HoleFilledSdf& field, const MeshSink& sink,
                    const std::stop_token& stop) {
  MarchingCubes(inside, field, sink).run(stop);
}

}  // namespace octurn
