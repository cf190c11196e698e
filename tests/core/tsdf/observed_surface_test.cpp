#include "tsdf/observed_surface.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/mesh/surface.hpp"

namespace octurn {
namespace {

constexpr double truncation = 0.0035;
constexpr double radius = 0.02;
const Eigen::Vector3d middle(0.001, -0.002, 0.03);

using IsSeen = std::function<bool(const Eigen::Vector3d&)>;

/// The TSDF of a ball of which snapshots saw only some places: samples within the truncation of its
/// surface there.
CompactTsdf ball_seen_in(const IsSeen& is_seen) {
  TsdfVolume volume(
      VoxelGrid(1.0, 10, {.min = {-0.03, -0.03, 0.0}, .max = {0.03, 0.03, 0.06}}, truncation));
  const VoxelGrid& grid = volume.grid();
  const auto centre = [&](int brick, int low, int voxel, std::size_t axis) {
    return grid.centre((brick + low) * VoxelGrid::brick_side + voxel, axis);
  };
  for (std::size_t at = 0; at < grid.brick_count(); ++at) {
    const auto i = static_cast<int>(at);
    const Index3 brick{i % grid.size().x, i / grid.size().x % grid.size().y,
                       i / grid.size().x / grid.size().y};
    for (std::size_t sample = 0; sample < TsdfBrick::samples; ++sample) {
      const auto s = static_cast<int>(sample);
      const Eigen::Vector3d point(centre(brick.x, grid.low().x, s % 8, 0),
                                  centre(brick.y, grid.low().y, s / 8 % 8, 1),
                                  centre(brick.z, grid.low().z, s / 64, 2));
      const double distance = (point - middle).norm() - radius;
      if (std::abs(distance) < truncation && is_seen(point)) {
        TsdfBrick& samples = *volume.make(brick);
        samples.distance[sample] =
            static_cast<std::int16_t>(distance / truncation * TsdfVolume::ticks);
        samples.weight[sample] = pack(1.0F);
      }
    }
  }
  CompactTsdf known(grid);
  known.add(volume);
  return known;
}

std::vector<Eigen::Vector3d> corners_of(const std::vector<Facet>& facets) {
  std::vector<Eigen::Vector3d> corners;
  for (const Facet& facet : facets) {
    const auto of_facet = facet.corners;
    for (const auto& corner : of_facet) {
      corners.emplace_back(Eigen::Vector3f(corner.data()).cast<double>() / 1000);
    }
  }
  return corners;
}

TEST(ObservedSurface, LiesWhereTheDistancesAreZeroOnSamplesOfAnySide) {
  const CompactTsdf known = ball_seen_in([](const Eigen::Vector3d&) { return true; });
  std::size_t finer = 0;
  for (const int side : {1, 2}) {
    const std::vector<Facet> facets = observed_surface(known, 0, side);
    EXPECT_TRUE(topology_of(facets).closed) << side;
    for (const Eigen::Vector3d& corner : corners_of(facets)) {
      ASSERT_NEAR((corner - middle).norm(), radius, 0.0001 * side * side);
    }
    for (const Facet& facet : facets) {
      ASSERT_EQ(facet.attributes, 0);
    }
    if (side == 2) {
      EXPECT_LT(facets.size(), finer / 3);
      EXPECT_GT(facets.size(), finer / 6);
    }
    finer = facets.size();
  }
}

TEST(ObservedSurface, FacesOutwards) {
  const CompactTsdf known = ball_seen_in([](const Eigen::Vector3d&) { return true; });
  const std::vector<Facet> facets = observed_surface(known, 0, 2);
  ASSERT_GT(facets.size(), 100U);
  for (const Facet& facet : facets) {
    const auto normal = facet.normal;
    const auto corners =
        facet.corners;  // a copy: a facet has STL's packed layout, so its corners are unaligned
    const Eigen::Vector3d outwards =
        Eigen::Vector3f(corners[0].data()).cast<double>() / 1000 - middle;
    EXPECT_GT(Eigen::Vector3f(normal.data()).cast<double>().dot(outwards), 0);
  }
}

TEST(ObservedSurface, IsOpenWhereNothingWasSeen) {
  const CompactTsdf known =
      ball_seen_in([](const Eigen::Vector3d& point) { return point.x() < middle.x(); });
  const std::vector<Facet> facets = observed_surface(known, 0, 2);
  ASSERT_GT(facets.size(), 500U);
  EXPECT_FALSE(topology_of(facets).closed);
  double least = 1;
  double most = -1;
  for (const Eigen::Vector3d& corner : corners_of(facets)) {
    least = std::min(least, corner.x());
    most = std::max(most, corner.x());
  }
  EXPECT_NEAR(least, middle.x() - radius, 0.0005);
  EXPECT_LT(most, middle.x());
  EXPECT_GT(most, middle.x() - 0.004);
}

TEST(ObservedSurface, BeginsAtTheBaseLayer) {
  const CompactTsdf known = ball_seen_in([](const Eigen::Vector3d&) { return true; });
  const int base_layer = 20;  // 20 mm up
  const std::vector<Facet> facets = observed_surface(known, base_layer, 1);
  ASSERT_FALSE(facets.empty());
  for (const Eigen::Vector3d& corner : corners_of(facets)) {
    EXPECT_GE(corner.z(), known.grid().centre(base_layer, 2) - 1e-6);
  }
}

}  // namespace
}  // namespace octurn
