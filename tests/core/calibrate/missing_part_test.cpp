#include "calibrate/missing_part.hpp"

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <utility>

#include "calibrate/checked_stop.hpp"
#include "mesh/surface_cells.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

/// Cells that a sensor saw on the sides of a post of 4 x 4 cm, from z = 5 mm up to `height`.
ScanFigures post_seen(double height, double distance = 0.65) {
  ScanFigures scan{.stops = 8, .distance = distance};
  for (double z = 0.0075; z < height; z += 0.005) {
    for (double along = -0.0175; along < 0.02; along += 0.005) {
      for (const double side : {-0.0175, 0.0175}) {
        scan.seen.emplace_back(along, side, z);
        scan.seen.emplace_back(side, along, z);
      }
    }
  }
  return scan;
}

/// A model of that post, `height` metres high, of 1 mm voxels.
ModelReport post_model(double height) {
  const double volume = 0.04 * 0.04 * height;
  SurfaceCells surface;
  for (const double side : {-0.02, 0.02}) {
    const std::array<Vector3d, 4> face = {Vector3d(side, -0.02, 0), Vector3d(side, 0.02, 0),
                                          Vector3d(side, -0.02, height),
                                          Vector3d(side, 0.02, height)};
    surface.add({face[0], face[1], face[2]});
    surface.add({face[1], face[2], face[3]});
    const auto turned = [&](std::size_t i) {
      return Vector3d(face[i].y(), face[i].x(), face[i].z());
    };
    surface.add({turned(0), turned(1), turned(2)});
    surface.add({turned(1), turned(2), turned(3)});
  }
  return {.leaves = static_cast<std::uint64_t>(volume / 1e-9),
          .places = {.surface = std::make_shared<SurfaceCells>(std::move(surface))},
          .volume = volume};
}

TEST(MissingPart, IsNoneOfAModelOfAllThatWasSeen) {
  EXPECT_FALSE(find_missing_part(post_seen(0.12), post_model(0.12)));
}

TEST(MissingPart, IsMeasuredAndPlaced) {
  const auto part = find_missing_part(post_seen(0.12), post_model(0.05));
  ASSERT_TRUE(part);
  // Cells within 8 mm, plus one 4 mm cell, of the model's surface count as part of the model.
  EXPECT_NEAR(mm_from_metres(part->length), 120 - 50 - 8 - 4, 6);
  ASSERT_FALSE(part->places.empty());
  for (const Vector3d& place : part->places) {
    EXPECT_GT(place.z(), 0.05);
  }
}

TEST(MissingPart, IsTheLargestOfSeveral) {
  ScanFigures scan = post_seen(0.12);
  for (double x = 0.1; x < 0.13; x += 0.005) {
    scan.seen.emplace_back(x, 0, 0.05);
    scan.seen.emplace_back(x, 0, 0.055);
  }
  const auto small = find_missing_part(scan, post_model(0.12));
  ASSERT_TRUE(small);
  EXPECT_NEAR(mm_from_metres(small->length), 30, 6);
  const auto large = find_missing_part(scan, post_model(0.05));
  ASSERT_TRUE(large);
  EXPECT_GT(mm_from_metres(large->length), 45);
}

TEST(MissingPart, IsNoSpeck) {
  ScanFigures scan = post_seen(0.12);
  scan.seen.insert(scan.seen.end(), {{0.1, 0, 0.05}, {0.105, 0, 0.05}, {0.11, 0, 0.05}});
  EXPECT_FALSE(find_missing_part(scan, post_model(0.12)));
}

TEST(MissingPart, IsNoTableThatIsBowed) {
  ScanFigures scan = post_seen(0.12);
  for (double x = 0.06; x < 0.1; x += 0.005) {
    scan.seen.emplace_back(x, 0, 0.0025);
    scan.seen.emplace_back(x, 0.005, 0.0025);
  }
  EXPECT_TRUE(find_missing_part(scan, post_model(0.12)));
  scan.below.noise_end = 0.004;
  EXPECT_FALSE(find_missing_part(scan, post_model(0.12)));
}

TEST(MissingPart, AllowsForANoiseThatGrowsWithTheSquareOfTheDistance) {
  ModelReport model = post_model(0.12);
  ScanFigures scan = post_seen(0.12);
  for (Vector3d& point : scan.seen) {
    point *= 1.7;  // its sides stand 14 mm outside the model's
    point.z() /= 1.7;
  }
  EXPECT_TRUE(find_missing_part(scan, model));
  scan.distance = 1.3;
  EXPECT_FALSE(find_missing_part(scan, model));
}

TEST(SeenCells, AreThoseOfMoreThanOneStop) {
  const std::vector<ObjectCell> first = {{0, 0, 0}, {0, 0, 1}, {3, -2, 1}};
  const std::vector<ObjectCell> second = {{0, 0, 1}, {3, -2, 1}};
  const std::vector<ObjectCell> third = {{-1, 0, 0}, {3, -2, 1}};
  const std::array stops = {&first, &second, &third};
  EXPECT_EQ(cells_of_several(stops), (std::vector<ObjectCell>{{0, 0, 1}, {3, -2, 1}}));
}

TEST(SeenCells, HoldTheirMiddle) {
  for (const Vector3d& point : {Vector3d(0.0012, -0.0012, 0.31), Vector3d(-0.14, 0.14, 0.4)}) {
    EXPECT_LT((find_middle(to_object_cell(point)) - point).cwiseAbs().maxCoeff(),
              object_cell_side / 2 + 1e-12);
  }
}

}  // namespace
}  // namespace octurn
