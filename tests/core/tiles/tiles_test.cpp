#include "octurn/tiles.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "bennett/marching_tetrahedra.hpp"
#include "bennett/triangulate.hpp"
#include "depth/back_project.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/units.hpp"
#include "support/room_scan.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"
#include "tiles/tile_lattice.hpp"
#include "voxel/memory_limit.hpp"

namespace octurn {
namespace {

constexpr std::size_t few_poses = 12;

ReconstructOptions room_options(Method method, double root_size) {
  return {.method = method,
          .leaf_size = 0.016,
          .root_size = root_size,
          .threshold = 0.01,
          .clip = everywhere};
}

std::string surface_of(const ReconstructOptions& options, std::size_t poses = few_poses) {
  const auto reconstruction = make_tiled_reconstructor(options);
  const SnapshotSource snapshots = room_scan(small_room(), poses);
  reconstruction->add(snapshots);
  std::vector<Facet> facets;
  reconstruction->surface(snapshots, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  return stl_text(facets);
}

std::vector<Facet> facets_of(const std::string& stl) {
  std::vector<Facet> facets((stl.size() - 84) / sizeof(Facet));
  std::memcpy(facets.data(), stl.data() + 84, facets.size() * sizeof(Facet));
  return facets;
}

MeshCheck check_of(const std::string& stl) {
  MeshCheck check;
  check.add(facets_of(stl));
  return check;
}

/// The facets of an STL file, sorted, so that surfaces can be compared as sets.
std::vector<std::string> sorted_facets(const std::string& stl) {
  std::vector<std::string> facets;
  for (std::size_t at = 84; at + sizeof(Facet) <= stl.size(); at += sizeof(Facet)) {
    facets.push_back(stl.substr(at, sizeof(Facet)));
  }
  std::ranges::sort(facets);
  return facets;
}

/// The STL of the surface from one octree around the whole room, without tiles.
std::string one_octree(const ReconstructOptions& options) {
  const TileLattice lattice(options);
  Octree octree(options.root_size, lattice.levels());
  for (std::size_t i = 0; i < few_poses; ++i) {
    const PointGrid grid = world_points(room_snapshot(small_room(), static_cast<int>(i)));
    triangulate(grid, static_cast<float>(options.threshold),
                [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c) {
                  const auto at = [&](const Eigen::Vector3f& point) {
                    return lattice.in_tile(*lattice.snap(point), {});
                  };
                  voxelize_triangle(octree, at(a), at(b), at(c), {}, lattice.leaf_bits());
                });
  }
  std::vector<Facet> facets;
  marching_tetrahedra(octree, all_layers(octree), 1, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  return stl_text(facets);
}

TEST(Tiles, HaveTheFacetsOfOneOctreeAroundThemAll) {
  const std::string tiled = surface_of(room_options(Method::intersection, 0.25));

  EXPECT_GT(tiled.size(), 100'000U);
  EXPECT_TRUE(sorted_facets(tiled) ==
              sorted_facets(one_octree(room_options(Method::intersection, 2))));
}

TEST(Tiles, GiveTheSameBytesWhateverTheirSide) {
  const std::string tiled = surface_of(room_options(Method::intersection, 0.25));

  EXPECT_TRUE(tiled == surface_of(room_options(Method::intersection, 0.5)));
  EXPECT_TRUE(tiled == surface_of(room_options(Method::intersection, 4)));
}

TEST(Tiles, AppearWhereSomethingIsSeen) {
  const ReconstructOptions options = room_options(Method::intersection, 0.25);

  const TilePlan plan = plan_tiles(options, room_scan(small_room(), 1));
  const TilePlan all = plan_tiles(options, room_scan(small_room(), few_poses));

  EXPECT_GT(plan.tiles.size(), 3U);
  EXPECT_LT(plan.tiles.size(), all.tiles.size());
  // Of the 6 x 6 x 5 tiles around the room, the 3 x 3 x 2 inner ones hold only air.
  EXPECT_LT(all.tiles.size(), 6U * 6 * 5 - 3 * 3 * 2);
  EXPECT_TRUE(std::ranges::none_of(all.tiles, [](const Tile& tile) {
    return tile.index == TileIndex{.x = 0, .y = 0, .z = 2};  // in the middle of the air
  }));
}

class TilesOf : public testing::TestWithParam<Method> {};

TEST_P(TilesOf, MakeAClosedSurface) {
  const std::string tiled = surface_of(room_options(GetParam(), 0.25));

  EXPECT_GT(tiled.size(), 100'000U);
  EXPECT_TRUE(check_of(tiled).closed());
}

TEST_P(TilesOf, GiveTheSameBytesUnderAMemoryLimitAndOnSeveralThreads) {
  ReconstructOptions options = room_options(GetParam(), 0.5);
  const std::string tiled = surface_of(options);

  options.threads = 3;
  EXPECT_TRUE(tiled == surface_of(options));
  options.memory_limit = (GetParam() == Method::solid ? 36 : 9) * mebibyte;
  EXPECT_TRUE(tiled == surface_of(options));
}

TEST_P(TilesOf, NameTheTileThatDoesNotFit) {
  ReconstructOptions options = room_options(GetParam(), 0.5);
  options.leaf_size = 0.0005;
  options.memory_limit = (GetParam() == Method::solid ? 20 : 9) * mebibyte;

  const Error error = error_thrown_by([&] { surface_of(options); });

  EXPECT_EQ(to_string(error.code()), "memory-limit");
  EXPECT_NE(std::string(error.what()).find("tile ("), std::string::npos) << error.what();
  EXPECT_EQ(error.parameters().at("limit_mb"),
            Parameters::mapped_type(GetParam() == Method::solid ? 20.0 : 9.0));
  EXPECT_GT(std::get<double>(error.parameters().at("needed_mb")),
            std::get<double>(error.parameters().at("limit_mb")));
}

INSTANTIATE_TEST_SUITE_P(Methods, TilesOf, testing::Values(Method::intersection, Method::solid),
                         [](const auto& method) { return std::string(to_string(method.param)); });

TEST(Shell, IsAsThickAsToldAndItsFrontLiesOnTheWalls) {
  ReconstructOptions options = room_options(Method::solid, 0.5);
  options.target_error = 0;
  const double thickness = shell_thickness(options);
  const Room room = small_room();
  const double floor_mm = mm_from_metres(room.walls.min.z());

  double highest_off = 0;
  double lowest_off = 0;
  int corners = 0;
  for (const Facet& facet : facets_of(surface_of(options, 40))) {
    for (const auto& corner : facet.corners) {  // on the floor, well away from walls and box
      if (std::abs(corner[0] + 200) < 100 && std::abs(corner[1]) < 100 && corner[2] < 200) {
        ++corners;
        const double from_floor = static_cast<double>(corner[2]) - floor_mm;
        const double below = -mm_from_metres(thickness);
        const bool is_front = from_floor > below / 2;
        double& off = is_front ? highest_off : lowest_off;
        off = std::max(off, std::abs(is_front ? from_floor : from_floor - below));
      }
    }
  }

  EXPECT_DOUBLE_EQ(thickness, 2 * 0.5 / 32);
  EXPECT_GT(corners, 500);
  EXPECT_LT(highest_off, 0.5);  // depth has steps of 0.2 mm
  EXPECT_LT(lowest_off, 3);     // a fifth of a voxel: interpolation between two voxels
}

TEST(Shell, HasTheVolumeOfTheWallsTimesItsThickness) {
  const ReconstructOptions options = room_options(Method::solid, 0.5);
  const Room room = small_room();
  const Eigen::Vector3d side = room.walls.max - room.walls.min;
  const double area = 2 * (side.x() * side.y() + side.y() * side.z() + side.z() * side.x());

  const MeshCheck check = check_of(surface_of(options, 60));

  // The box and the corners of the walls add volume; the floor in the box's shadow is missing.
  const double expected = area * shell_thickness(options);
  EXPECT_GT(m3_from_mm3(check.volume_mm3()), 0.95 * expected);
  EXPECT_LT(m3_from_mm3(check.volume_mm3()), 1.25 * expected);
}

}  // namespace
}  // namespace octurn
