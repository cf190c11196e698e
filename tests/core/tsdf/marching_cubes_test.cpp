#include "tsdf/marching_cubes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/random_field.hpp"
#include "core/tsdf/rendered.hpp"
#include "octurn/units.hpp"
#include "voxel/connected_components.hpp"

namespace octurn {
namespace {

/// Casts a ray along each row of voxels, a little beside their centres, and visits each voxel with
/// its winding number, exits minus entries ahead: 1 inside a closed surface, 0 outside.
template <typename Visit>
void for_each_winding(const HoleFilledSdf& filled, const std::vector<Facet>& facets, Visit visit) {
  struct Crossing {
    double x = 0;
    int turn = 0;
  };
  const double voxel_mm = mm_from_metres(filled.voxel_side());
  const Index3 low = filled.low();
  const Index3 end = filled.end();
  const auto centre_mm = [&](int voxel, std::size_t axis) {
    return mm_from_metres(filled.centre(voxel, axis));
  };
  // Vertices keep at least 0.025 voxels from voxel centres, so a ray beside the centres passes
  // every vertex on the same side as a ray through them.
  const double beside_y = 0.00113 * voxel_mm;
  const double beside_z = 0.00071 * voxel_mm;
  std::map<std::pair<int, int>, std::vector<Crossing>> rows;
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    const Eigen::Vector3d a = Eigen::Vector3f(corners[0].data()).cast<double>();
    const Eigen::Vector3d b = Eigen::Vector3f(corners[1].data()).cast<double>();
    const Eigen::Vector3d c = Eigen::Vector3f(corners[2].data()).cast<double>();
    const Eigen::Vector3d least = a.cwiseMin(b).cwiseMin(c);
    const Eigen::Vector3d most = a.cwiseMax(b).cwiseMax(c);
    for (int z = low.z - 1; z < end.z; ++z) {
      const double at_z = centre_mm(z, 2) + beside_z;
      if (at_z < least.z() || at_z > most.z()) {
        continue;
      }
      for (int y = low.y; y < end.y; ++y) {
        const double at_y = centre_mm(y, 1) + beside_y;
        if (at_y < least.y() || at_y > most.y()) {
          continue;
        }
        // Twice the areas of the three triangles, projected along the row, between the ray and the
        // facet's edges.
        const auto area = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
          return (p.y() - at_y) * (q.z() - at_z) - (q.y() - at_y) * (p.z() - at_z);
        };
        const double ab = area(a, b);
        const double bc = area(b, c);
        const double ca = area(c, a);
        if ((ab > 0 && bc > 0 && ca > 0) || (ab < 0 && bc < 0 && ca < 0)) {
          rows[{y, z}].push_back({.x = (bc * a.x() + ca * b.x() + ab * c.x()) / (ab + bc + ca),
                                  .turn = ab > 0 ? 1 : -1});
        }
      }
    }
  }
  for (int z = low.z; z < end.z; ++z) {
    for (int y = low.y; y < end.y; ++y) {
      const std::vector<Crossing>& row = rows[{y, z}];
      for (int x = low.x; x < end.x; ++x) {
        int winding = 0;
        for (const Crossing& crossing : row) {
          winding += crossing.x > centre_mm(x, 0) ? crossing.turn : 0;
        }
        visit(Index3{x - low.x, y - low.y, z - low.z}, winding);
      }
    }
  }
}

/// Counts the connected components: facets are connected if they share a corner.
int parts_of(const std::vector<Facet>& facets) {
  std::map<std::array<float, 3>, std::size_t> names;
  std::vector<std::size_t> parent;
  const auto root = [&](const std::array<float, 3>& corner) {
    const auto [found, is_new] = names.try_emplace(corner, parent.size());
    if (is_new) {
      parent.push_back(found->second);
    }
    std::size_t at = found->second;
    while (parent[at] != at) {
      parent[at] = parent[parent[at]];
      at = parent[at];
    }
    return at;
  };
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    parent[root(corners[1])] = root(corners[0]);
    parent[root(corners[2])] = root(corners[0]);
  }
  int parts = 0;
  for (std::size_t i = 0; i < parent.size(); ++i) {
    parts += parent[i] == i ? 1 : 0;
  }
  return parts;
}

TEST(MarchingCubes, IsClosedAndManifoldWhateverTheSigns) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const CompactTsdf field = random_field(seed, 0.2 * seed);
    const HoleFilledSdf filled(field, 3);
    const std::vector<Facet> facets = surface_of(filled.inside(), filled);
    ASSERT_GT(facets.size(), 1000U);
    EXPECT_TRUE(topology_of(facets).manifold) << "seed " << seed;
  }
}

TEST(MarchingCubes, OfAKeptPartIsOnePart) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const CompactTsdf field = random_field(seed, 0.2 * seed);
    const HoleFilledSdf filled(field, 3);
    VoxelMask part = filled.inside();
    keep_main_component(part);
    part.fill_cavities();
    EXPECT_EQ(part.component_count(), 1U);
    const std::vector<Facet> facets = surface_of(part, filled);
    EXPECT_EQ(parts_of(facets), 1) << "seed " << seed;
    EXPECT_TRUE(topology_of(facets).manifold) << "seed " << seed;
  }
}

TEST(MarchingCubes, KeepsVerticesApart) {
  const CompactTsdf field = random_field(7, 0.4);
  const HoleFilledSdf filled(field, 3);
  const std::vector<Facet> facets = surface_of(filled.inside(), filled);
  ASSERT_GT(facets.size(), 1000U);
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f a(corners[i].data());
      const Eigen::Vector3f b(corners[(i + 1) % 3].data());
      EXPECT_GT((a - b).norm(), 0.0355F);  // millimetres; 0.036, rounded
    }
  }
}

TEST(MarchingCubes, LiesWhereTheFieldIsZero) {
  const Shape shape = ball({0.0002, -0.0003, 0.0141}, 0.01);
  TsdfVolume volume(
      VoxelGrid(1.0, 10, {.min = {-0.012, -0.012, 0.002}, .max = {0.012, 0.012, 0.026}}, 0.0035));
  const VoxelGrid& grid = volume.grid();
  for_each_inner_brick(grid, [&](const Index3& index) {
    TsdfBrick& brick = *volume.make(index);
    for (int i = 0; i < static_cast<int>(TsdfBrick::samples); ++i) {
      const auto centre = [&](int at, int low, int voxel, std::size_t axis) {
        return grid.centre((at + low) * VoxelGrid::brick_side + voxel, axis);
      };
      const double distance = shape({centre(index.x, grid.low().x, i % 8, 0),
                                     centre(index.y, grid.low().y, i / 8 % 8, 1),
                                     centre(index.z, grid.low().z, i / 64, 2)});
      const double share = std::clamp(distance / grid.truncation(), -1.0, 1.0);
      brick.distance[static_cast<std::size_t>(i)] =
          static_cast<std::int16_t>(std::lround(share * TsdfVolume::ticks));
      brick.weight[static_cast<std::size_t>(i)] = pack(1);
    }
  });
  CompactTsdf known(grid);
  known.add(volume);
  const HoleFilledSdf filled(known, 3);
  const std::vector<Facet> facets = surface_of(filled.inside(), filled);
  EXPECT_GT(facets.size(), 1000U);
  for (const Facet& facet : facets) {
    const auto corners = facet.corners;
    for (const auto& corner : corners) {
      const Eigen::Vector3d point = Eigen::Vector3f(corner.data()).cast<double>() / 1000;
      // Linear interpolation along an edge of length h errs by h^2 / 8 r, and vertices keep 0.025
      // mm from voxel centres.
      EXPECT_NEAR(shape(point), 0, 0.000012 + 0.000026);
    }
  }
}

TEST(MarchingCubes, PartsEveryVoxelInsideFromEveryVoxelOutside) {
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    const CompactTsdf field = random_field(seed, 0.2 * seed);
    const HoleFilledSdf filled(field, 3);
    const VoxelMask inside = filled.inside();
    std::size_t voxels_inside = 0;
    std::size_t wrong = 0;
    for_each_winding(filled, surface_of(inside, filled), [&](const Index3& voxel, int winding) {
      const bool is_inside = inside.contains(voxel.x, voxel.y, voxel.z);
      voxels_inside += is_inside ? 1 : 0;
      wrong += winding != (is_inside ? 1 : 0) ? 1 : 0;
    });
    EXPECT_EQ(wrong, 0U) << "seed " << seed;
    EXPECT_EQ(voxels_inside, inside.count());
    EXPECT_GT(voxels_inside, 500U);
  }
}

}  // namespace
}  // namespace octurn
