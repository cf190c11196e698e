#include <gtest/gtest.h>

#include <array>

#include "core/register/laid_down.hpp"
#include "register/nearest_points.hpp"

namespace octurn {
namespace {

constexpr double margin = 0.02;  // metres: a voxel's diagonal, and the margin before a surface

/// Whether a point of the object's frame is free according to one turn, placed by its pose.
bool is_free(const SeenTurn& turn, const Eigen::Isometry3d& object_from_turn,
             const Eigen::Vector3d& point) {
  const std::array turns{PlacedTurn{.turn = &turn, .object_from_turn = object_from_turn}};
  return FreeSpace(turns, 1, {}).is_free(point);
}

TEST(FreeSpace, IsAboveAndBesideABlockAndBelowItsPlatform) {
  const Eigen::Vector3d size(0.09, 0.06, 0.05);
  const SeenTurn turn = read_turn(laid_turn(block(size), 4), 1, {});
  const Eigen::Isometry3d stands = Eigen::Isometry3d::Identity();

  EXPECT_TRUE(is_free(turn, stands, {0, 0, size.z() + margin}));
  EXPECT_TRUE(is_free(turn, stands, {0, size.y() / 2 + margin, 0.03}));
  EXPECT_TRUE(is_free(turn, stands, {0, 0, -0.01}));
  EXPECT_TRUE(is_free(turn, stands, {1, 0, 0.02}));
  EXPECT_FALSE(is_free(turn, stands, {0, 0, 0.02}));
  EXPECT_FALSE(is_free(turn, stands, {0, 0, size.z()}));
  EXPECT_FALSE(is_free(turn, stands, {0, 0, 0.003}));
}

TEST(FreeSpace, IsWhereTheTurnLay) {
  const SeenTurn turn = read_turn(laid_turn(block({0.09, 0.06, 0.05}), 4), 1, {});
  Eigen::Isometry3d upside_down = Eigen::Isometry3d::Identity();
  upside_down.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();

  EXPECT_TRUE(is_free(turn, upside_down, {0, 0, 0.01}));
  EXPECT_FALSE(is_free(turn, upside_down, {0, 0, -0.02}));
}

}  // namespace
}  // namespace octurn
