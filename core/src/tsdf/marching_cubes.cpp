#include "tsdf/marching_cubes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "tsdf/marching_cubes_cases.hpp"

namespace octurn {
namespace {

/// The cubes between two layers of a mask's voxels that its surface crosses.
struct CubeLayer {
  struct Cube {
    int x = 0;  ///< of the lowest corner
    int y = 0;
    std::uint8_t pattern = 0;  ///< a bit for each corner that is inside, as in marching_cubes_cases
  };
  std::vector<Cube> mixed = {};  ///< row by row
  /// For each cube, row by row, 1 if it is of a case whose triangles could intersect; empty if none
  /// is.
  std::vector<std::uint8_t> ambiguous = {};
};

using Row = std::span<const std::uint64_t>;

/// Adds the cubes that the surface crosses, of 64 along x.
/// @param rows   of voxels that they lie between
/// @param width  of the mask, voxels
/// @param size   of a layer of the mask, voxels
void add_mixed(const std::array<Row, 4>& rows, std::size_t word, int y, int width, std::size_t size,
               CubeLayer& layer) {
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
      layer.ambiguous.resize(size);
      layer.ambiguous[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                      static_cast<std::size_t>(x)] = 1;
    }
  }
}

/// The cubes between the layers z and z + 1 of a mask. Voxels outside the mask are outside the
/// object.
CubeLayer mixed_cubes(const VoxelMask& inside, int z) {
  CubeLayer layer;
  const Index3& voxels = inside.size();
  const std::vector<std::uint64_t> empty(inside.words_per_row());
  const std::size_t size = static_cast<std::size_t>(voxels.x) * static_cast<std::size_t>(voxels.y);
  const auto row = [&](int y, int at) {
    return at >= 0 && at < voxels.z ? inside.row(y, at) : Row(empty);
  };
  for (int y = 0; y + 1 < voxels.y; ++y) {
    const std::array rows{row(y, z), row(y + 1, z), row(y, z + 1), row(y + 1, z + 1)};
    for (std::size_t word = 0; word < empty.size(); ++word) {
      add_mixed(rows, word, y, voxels.x, size, layer);
    }
  }
  return layer;
}

/// Consecutive pieces of a mesh, kept until they can be streamed in order. Vertex numbers begin
/// with the piece before them.
class MeshPieces {
 public:
  void add(const MeshPiece& piece) {
    vertices_.insert(vertices_.end(), piece.vertices.begin(), piece.vertices.end());
    triangles_.insert(triangles_.end(), piece.triangles.begin(), piece.triangles.end());
    ends_.push_back({vertices_.size(), triangles_.size()});
  }

  void clear() {
    vertices_.clear();
    triangles_.clear();
    ends_.clear();
  }

  std::size_t vertex_count() const { return vertices_.size(); }

  /// @param first  number, in the whole mesh, of the first vertex of the piece before these
  void stream(std::uint32_t first, const MeshSink& sink) {
    for (MeshTriangle& triangle : triangles_) {
      for (std::uint32_t& corner : triangle) {
        corner += first;
      }
    }
    End begin;
    for (const End& end : ends_) {
      sink({.vertices = std::span(vertices_).subspan(begin.vertices, end.vertices - begin.vertices),
            .triangles =
                std::span(triangles_).subspan(begin.triangles, end.triangles - begin.triangles)});
      begin = end;
    }
  }

 private:
  struct End {
    std::size_t vertices = 0;
    std::size_t triangles = 0;
  };
  std::vector<MeshVertex> vertices_ = {};
  std::vector<MeshTriangle> triangles_ = {};
  std::vector<End> ends_ = {};
};

/// Slicers meld vertices that are closer than this: CuraEngine below 0.030 mm.
constexpr double min_gap_mm = 0.036;

/// On edges of the few cases whose triangles could intersect, vertices keep this share of the edge
/// from its ends.
constexpr float ambiguous_margin = 0.3F;

constexpr int layers_at_once = 4;  // drawn by a thread, which also reads the layer below them

constexpr CubeRange all_cubes{
    .low = {-1, -1, -1},
    .end = {std::numeric_limits<int>::max(), std::numeric_limits<int>::max(),
            std::numeric_limits<int>::max()}};

/// @tparam Field  `HoleFilledSdf`, `EditedSdf` or `ShellField`
template <typename Field>
class MarchingCubes {
 public:
  MarchingCubes(const VoxelMask& inside, const Field& field, const CubeRange& range = all_cubes)
      : inside_(inside),
        field_(field),
        range_(range),
        width_(static_cast<std::size_t>(inside.size().x)) {
    const std::size_t layer = width_ * static_cast<std::size_t>(inside.size().y);
    for (auto& indices : indices_) {
      indices.resize(layer);
    }
    end_margin_ = static_cast<float>(
        std::min(min_gap_mm / (std::numbers::sqrt2 * mm_from_metres(field.voxel_side())), 0.3));
  }

  /// Draws the layers of cubes from `first` to below `end`. Vertex numbers continue those of the
  /// layer below `first`.
  /// @returns the number of that layer's vertices
  std::uint32_t run(int first, int end, const MeshSink& sink, const std::stop_token& stop) {
    CubeLayer below = first > -1 ? mixed_cubes(inside_, first - 1) : CubeLayer{};
    CubeLayer here = mixed_cubes(inside_, first);
    number_vertices(below, first - 1);
    const std::uint32_t before = vertex_count_;
    for (int z = first; z < end; ++z) {
      throw_if_stopped(stop);
      CubeLayer above = mixed_cubes(inside_, z + 1);
      vertices_.clear();
      triangles_.clear();
      for (const CubeLayer::Cube& cube : here.mixed) {
        if (is_drawn({cube.x, cube.y, z})) {
          add_cube(cube, z, below, here, above);
        }
      }
      if (!triangles_.empty()) {
        sink({.vertices = vertices_, .triangles = triangles_});
      }
      move_up();
      below = std::move(here);
      here = std::move(above);
    }
    return before;
  }

 private:
  /// The upper x and y edges of this layer of cubes become the lower ones of the next.
  void move_up() {
    std::swap(indices_[0], indices_[3]);
    std::swap(indices_[1], indices_[4]);
    for (const std::size_t used : {2U, 3U, 4U}) {
      std::ranges::fill(indices_[used], 0U);
    }
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

  /// Makes the vertices of a layer of cubes; those on its lower side belong to the layer below.
  void number_vertices(const CubeLayer& layer, int z) {
    vertex_count_ = 0;
    for (const CubeLayer::Cube& cube : layer.mixed) {
      const CubeSurface& surface = marching_cubes_cases[cube.pattern];
      for (const auto& triangle : std::span(surface.triangles).first(surface.count)) {
        for (const CubeEdge edge : triangle) {
          const auto [voxel, axis, is_above] = find_place(edge, {cube.x, cube.y, z});
          std::uint32_t& index = index_at(voxel, axis, is_above);
          if ((axis == 2 || is_above) && index == 0) {
            index = ++vertex_count_;
          }
        }
      }
    }
    move_up();
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
        const auto [voxel, axis, is_above] =
            find_place(surface.triangles[i][corner], {cube.x, cube.y, z});
        std::uint32_t& index = index_at(voxel, axis, is_above);
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

  struct EdgePlace {
    Index3 voxel = {};  // where the edge begins
    std::size_t axis = 0;
    bool is_above = false;  // on the upper side of its layer of cubes
  };

  static EdgePlace find_place(CubeEdge edge, const Index3& cube) {
    const std::size_t axis = edge_axis(edge);
    const Index3 voxel = find_start(edge, cube);
    return {.voxel = voxel, .axis = axis, .is_above = axis < 2 && voxel.z > cube.z};
  }

  std::uint32_t& index_at(const Index3& voxel, std::size_t axis, bool is_above) {
    return indices_[axis + (is_above ? 3 : 0)][at(voxel.x, voxel.y)];
  }

  /// @param below, above  the layers of cubes that meet in the edge from `voxel` along `axis`
  MeshVertex vertex(const Index3& voxel, std::size_t axis, const CubeLayer& below,
                    const CubeLayer& above) const {
    const Index3& low = inside_.low();
    Index3 first{voxel.x + low.x, voxel.y + low.y, voxel.z + low.z};
    Index3 second = first;
    (axis == 0 ? second.x : axis == 1 ? second.y : second.z) += 1;
    const bool first_inside = inside_.contains(voxel.x, voxel.y, voxel.z);
    const auto [a, b] = values(first, second, first_inside);
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

  /// The values at both ends of an edge.
  std::pair<HoleFilledSdf::Value, HoleFilledSdf::Value> values(const Index3& first,
                                                               const Index3& second,
                                                               bool first_inside) const {
    if constexpr (std::is_same_v<Field, EditedSdf>) {
      if (first_inside) {
        return field_.edge(first, second);
      }
      const auto [inside, outside] = field_.edge(second, first);
      return {outside, inside};
    } else {
      return {field_.at(first), field_.at(second)};
    }
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
  CubeRange range_;
  std::size_t width_;
  float end_margin_ = 0;
  // Vertex indices plus 1 (0: none yet) by the voxel that an edge begins at: along x and y below
  // the cubes, along z, along x and y above.
  std::array<std::vector<std::uint32_t>, 5> indices_ = {};
  std::uint32_t vertex_count_ = 0;
  std::vector<MeshVertex> vertices_ = {};
  std::vector<MeshTriangle> triangles_ = {};
};

/// The piece that one thread draws.
template <typename Field>
struct Part {
  MarchingCubes<Field> cubes;
  MeshPieces pieces = {};
  std::uint32_t before = 0;  // vertices of the layer below
};

template <typename Field>
void draw_all_cubes(const VoxelMask& inside, const Field& field, const MeshSink& sink,
                    const std::stop_token& stop, ThreadTeam& team) {
  const int layers = inside.size().z;
  if (team.size() == 1) {
    MarchingCubes(inside, field).run(-1, layers, sink, stop);
    return;
  }
  // Each thread draws some layers at a time, from below; the pieces are handed on in their order.
  std::vector<Part<Field>> parts(static_cast<std::size_t>(team.size()),
                                 {.cubes = MarchingCubes(inside, field)});
  std::uint32_t vertices = 0;
  for (int low = -1; low < layers; low += team.size() * layers_at_once) {
    team.run([&](int thread) {
      Part<Field>& part = parts[static_cast<std::size_t>(thread)];
      part.pieces.clear();
      const int first = low + thread * layers_at_once;
      if (first < layers) {
        part.before = part.cubes.run(
            first, std::min(first + layers_at_once, layers),
            [&](const MeshPiece& piece) { part.pieces.add(piece); }, stop);
      }
    });
    for (Part<Field>& part : parts) {
      part.pieces.stream(vertices - part.before, sink);
      vertices += static_cast<std::uint32_t>(part.pieces.vertex_count());
    }
  }
}

}  // namespace

void marching_cubes(const VoxelMask& inside, const HoleFilledSdf& sdf, const MeshSink& sink,
                    const std::stop_token& stop, ThreadTeam& team) {
  draw_all_cubes(inside, sdf, sink, stop, team);
}

void marching_cubes(const VoxelMask& inside, const EditedSdf& sdf, const MeshSink& sink,
                    const std::stop_token& stop, ThreadTeam& team) {
  draw_all_cubes(inside, sdf, sink, stop, team);
}

void marching_cubes(const VoxelMask& inside, const ShellField& shell, const CubeRange& range,
                    const MeshSink& sink, const std::stop_token& stop) {
  MarchingCubes(inside, shell, range).run(-1, inside.size().z, sink, stop);
}

}  // namespace octurn
