#include "tsdf/observed_surface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "mesh/mesh.hpp"
#include "octurn/snapshot.hpp"
#include "octurn/units.hpp"
#include "tsdf/marching_cubes_cases.hpp"

namespace octurn {
namespace {

constexpr float unknown = std::numeric_limits<float>::infinity();

// A crossing keeps this share of an edge from its ends, so that every triangle has an area.
constexpr float end_margin = 0.05F;

/// Counts of the voxels of a coarse sample.
struct SampleSum {
  int near = 0;  // observed, or right behind an observed surface
  int free = 0;
  float distance = 0;  // sum over the near voxels, ticks

  float mean(int voxels) const {
    if (4 * near >= voxels && near >= free) {
      return distance / static_cast<float>(near);
    }
    return 2 * free >= voxels ? static_cast<float>(VoxelGrid::ticks) : unknown;
  }
};

class ObservedSurface {
 public:
  ObservedSurface(const CompactTsdf& known, int base_layer, int side)
      : known_(known),
        grid_(known.grid()),
        base_layer_(base_layer - grid_.low().z * brick_side),
        side_(side),
        size_{coarse(grid_.size().x), coarse(grid_.size().y), coarse(grid_.size().z)} {}

  std::vector<Facet> draw(const std::stop_token& stop) {
    below_ = sample_layer(0);
    for (int z = 0; z + 1 < size_.z; ++z) {
      throw_if_stopped(stop);
      above_ = sample_layer(z + 1);
      for (int y = 0; y + 1 < size_.y; ++y) {
        for (int x = 0; x + 1 < size_.x; ++x) {
          add_cube({x, y, z});
        }
      }
      std::swap(below_, above_);
    }
    return std::move(facets_);
  }

 private:
  using Layer = std::vector<float>;  // distances, ticks, or `unknown`; x the fastest

  int coarse(int bricks) const { return (bricks * brick_side + side_ - 1) / side_; }

  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x) +
           static_cast<std::size_t>(x);
  }

  Layer sample_layer(int z) const {
    std::vector<SampleSum> sums(at(0, size_.y));
    const int end = std::min((z + 1) * side_, grid_.size().z * brick_side);
    for (int voxel = std::max(z * side_, base_layer_); voxel < end; ++voxel) {
      for (int y = 0; y < grid_.size().y; ++y) {
        for (int x = 0; x < grid_.size().x; ++x) {
          if (const CompactBrick* brick = known_.find({x, y, voxel / brick_side})) {
            add_voxels(*brick, {x, y, voxel % brick_side}, sums);
          }
        }
      }
    }
    Layer layer(sums.size());
    std::ranges::transform(
        sums, layer.begin(),
        [voxels = side_ * side_ * side_](const SampleSum& sum) { return sum.mean(voxels); });
    return layer;
  }

  /// @param place  of the brick in x and y, and the layer of its voxels in z
  void add_voxels(const CompactBrick& brick, const Index3& place,
                  std::vector<SampleSum>& sums) const {
    auto sample = static_cast<std::size_t>(place.z * brick_side * brick_side);
    for (int y = place.y * brick_side; y < (place.y + 1) * brick_side; ++y) {
      for (int x = place.x * brick_side; x < (place.x + 1) * brick_side; ++x, ++sample) {
        SampleSum& sum = sums[at(x / side_, y / side_)];
        switch (brick.state(sample)) {
          case VoxelState::observed:
          case VoxelState::occluded:
            ++sum.near;
            sum.distance += static_cast<float>(brick.distance[sample]);
            break;
          case VoxelState::free:
            ++sum.free;
            break;
          case VoxelState::unknown:
            break;
        }
      }
    }
  }

  float distance(const Index3& sample, int lowest) const {
    return (sample.z == lowest ? below_ : above_)[at(sample.x, sample.y)];
  }

  void add_cube(const Index3& cube) {
    std::size_t pattern = 0;
    for (std::size_t corner = 0; corner < 8; ++corner) {
      const float value = distance(cube_corner(cube, corner), cube.z);
      if (value == unknown) {
        return;
      }
      pattern |= static_cast<std::size_t>(value < 0) << corner;
    }
    const CubeSurface& surface = marching_cubes_cases[pattern];
    for (std::size_t i = 0; i < surface.count; ++i) {
      const auto& [a, b, c] = surface.triangles[i];
      facets_.push_back(to_facet({crossing(a, cube), crossing(b, cube), crossing(c, cube)}));
    }
  }

  /// Where the surface crosses an edge of a cube.
  MeshVertex crossing(CubeEdge edge, const Index3& cube) const {
    const std::size_t axis = edge_axis(edge);
    const Index3 first = find_start(edge, cube);
    Index3 second = first;
    (axis == 0 ? second.x : axis == 1 ? second.y : second.z) += 1;
    const float from = distance(first, cube.z);
    const float fraction =
        std::clamp(from / (from - distance(second, cube.z)), end_margin, 1 - end_margin);
    MeshVertex vertex{.position = {}, .observed = true};
    const std::array<int, 3> at{first.x, first.y, first.z};
    const std::array<int, 3> low{grid_.low().x, grid_.low().y, grid_.low().z};
    for (std::size_t i = 0; i < 3; ++i) {
      const double steps = at[i] + 0.5 + (i == axis ? static_cast<double>(fraction) : 0.0);
      vertex.position[i] = static_cast<float>(mm_from_metres(
          grid_.centre(low[i] * brick_side, i) + (steps * side_ - 0.5) * grid_.voxel_side()));
    }
    return vertex;
  }

  const CompactTsdf& known_;
  const VoxelGrid& grid_;
  int base_layer_;  // counted from the grid's lowest
  int side_;
  Index3 size_;  // coarse samples
  Layer below_ = {};
  Layer above_ = {};
  std::vector<Facet> facets_ = {};
};

}  // namespace

std::vector<Facet> observed_surface(const CompactTsdf& known, int base_layer, int side,
                                    const std::stop_token& stop) {
  return ObservedSurface(known, base_layer, side).draw(stop);
}

}  // namespace octurn
