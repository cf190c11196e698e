#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/bennett/comparison.hpp"
#include "core/bennett/plain_octree.hpp"
#include "core/mesh/surface.hpp"

// For any triangles (tiny, huge, degenerate, on leaf faces, outside the root) the octree has the
// plain octree's leaves, at every level and for any slabs. Its surface is the plain one's, closed
// and manifold, also where leaves touch at an edge or a corner only: around two such leaves and the
// two empty ones beside them the tetrahedra decide consistently, so that no edge gets four facets
// and no vertex two fans.

namespace {

using namespace octurn;

constexpr int most_triangles = 12;
constexpr int most_leaves_across = 40;  // per triangle, as the plain octree is slow
constexpr std::size_t most_leaves = 3000;

void require(bool promise) {
  if (!promise) {
    std::abort();
  }
}

/// Reads numbers from the input's bytes, and zeros after their end.
class Bytes {
 public:
  explicit Bytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool empty() const { return bytes_.empty(); }

  std::uint32_t take(std::size_t count) {
    std::uint32_t value = 0;
    for (; count > 0 && !bytes_.empty(); --count) {
      value = value << 8U | bytes_.front();
      bytes_ = bytes_.subspan(1);
    }
    return value;
  }

  /// An integer in [low, high].
  int between(int low, int high, std::size_t count) {
    return low + static_cast<int>(take(count) % static_cast<std::uint32_t>(high - low + 1));
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

constexpr int root = 1 << SnapGrid::bits;
using Corners = std::array<SnapPoint, 3>;

std::int32_t in_reach(int at) { return std::clamp(at, -root, 2 * root - 1) | 1; }

/// A triangle on the snap grid. Corners are anywhere, or offsets from the first in grid units or in
/// leaves.
Corners grid_triangle(Bytes& bytes, int levels, int kind) {
  const int leaf = 1 << (SnapGrid::bits - levels);
  Corners corners{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::int32_t& at = corners[i][axis];
      if (kind == 0 || i == 0) {
        at = in_reach(bytes.between(-root, 2 * root - 1, 3));
      } else if (kind == 1) {
        at = in_reach(corners[0][axis] + bytes.between(-128, 127, 1));
      } else {  // next to a leaf face, on either side
        const int offset = bytes.between(-128, 127, 1);
        at = in_reach((corners[0][axis] / leaf + offset / 4) * leaf - offset % 2);
      }
    }
  }
  return corners;
}

/// A triangle whose corners are arbitrary bit patterns as metres, including infinities and NaN.
std::optional<Corners> metre_triangle(Bytes& bytes, const SnapGrid& snap_grid) {
  Corners corners{};
  for (SnapPoint& corner : corners) {
    const auto metres = [&] { return std::bit_cast<float>(bytes.take(4)); };
    const float x = metres();
    const float y = metres();
    const auto nearest = snap_grid.snap({x, y, metres()});
    if (!nearest) {
      return std::nullopt;
    }
    corner = *nearest;
  }
  return corners;
}

std::vector<Corners> soup_from(Bytes& bytes, int levels) {
  std::vector<Corners> soup;
  const SnapGrid snap_grid(1.0);
  for (int i = 0; i < most_triangles && !bytes.empty(); ++i) {
    const int kind = bytes.between(0, 3, 1);
    const std::optional<Corners> corners =
        kind == 3 ? metre_triangle(bytes, snap_grid) : grid_triangle(bytes, levels, kind);
    if (corners && leaves_across(*corners, levels) <= most_leaves_across) {
      soup.push_back(*corners);
    }
  }
  return soup;
}

/// The surface made slab by slab, each from an octree with the slab's layers only.
std::vector<Facet> surface_by_slabs(const std::vector<Corners>& soup, int levels, int height) {
  std::vector<Facet> facets;
  const int top = all_layers(Octree(1.0, levels)).end;
  for (int low = 0; low < top; low += height) {
    const BrickLayers slab{.low = low, .end = std::min(top, low + height)};
    Octree octree(1.0, levels);
    for (const auto& [a, b, c] : soup) {
      voxelize_triangle(octree, a, b, c,
                        {.low = low * Brick::side, .high = slab.end * Brick::side});
    }
    marching_tetrahedra(octree, slab, 1, [&](std::span<const Facet> some) {
      facets.insert(facets.end(), some.begin(), some.end());
    });
  }
  return facets;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(std::span(data, size));
  const int levels = bytes.between(0, Octree::max_levels, 1);
  const int coarser = bytes.between(0, levels, 1);
  const std::vector<Corners> soup = soup_from(bytes, levels);

  Octree octree(1.0, levels);
  plain::Octree plain(levels);
  for (const Corners& corners : soup) {
    voxelize_triangle(octree, corners[0], corners[1], corners[2]);
    plain.voxelize(corners);
  }
  require(leaves_of(octree) == plain.leaves());
  require(octree.leaf_count() == plain.leaves().size());
  require(leaves_of(octree.at_level(coarser)) == plain.nodes(coarser));
  if (plain.leaves().size() > most_leaves) {
    return 0;
  }
  const std::vector<Facet> facets = surface_of(octree);
  require(in_half_leaves(octree, facets) == plain::marching_tetrahedra(plain.leaves()));
  require(count_facets(octree, all_layers(octree)) == facets.size());
  const Topology topology = topology_of(facets);
  require(topology.closed && topology.manifold);
  if (levels <= 8) {
    require(same_bytes(surface_by_slabs(soup, levels, 1 + coarser), facets));
  }
  return 0;
}
