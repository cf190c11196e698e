#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "board_picture.hpp"
#include "octurn/lens.hpp"

namespace octurn {
namespace {

/// Errors of the found corners, and the share of corners found.
struct Comparison {
  double worst = 0;  // pixels
  double mean = 0;   // pixels
  double found = 0;  // share of the true corners
};

Comparison compare(const BoardView& view, const std::vector<Eigen::Vector2d>& truth) {
  Comparison all;
  for (const BoardCorner& corner : view) {
    double nearest = 1e9;
    for (const Eigen::Vector2d& at : truth) {
      nearest = std::min(nearest, (at - corner.pixel).norm());
    }
    all.worst = std::max(all.worst, nearest);
    all.mean += nearest / static_cast<double>(view.size());
  }
  all.found = static_cast<double>(view.size()) / static_cast<double>(truth.size());
  return all;
}

Comparison look(const BoardScene& scene, const Eigen::Isometry3d& pose) {
  return compare(find_board(board_picture(scene, pose)), true_corners(scene, pose));
}

/// Expects at least 20 corners, no two of them with the same column and row.
void expect_lattice(const BoardView& view) {
  std::set<std::pair<int, int>> places;
  for (const BoardCorner& corner : view) {
    EXPECT_TRUE(places.insert({corner.column, corner.row}).second) << "a place is taken twice";
  }
  EXPECT_GT(places.size(), 19U);
}

TEST(FindBoard, FindsEachCornerOfABoardSeenStraight) {
  const BoardScene scene{.lens = test_lens()};
  const Eigen::Isometry3d pose = board_at({0, 0, 0.33}, 0.05, -0.04, 0.03);
  const BoardView view = find_board(board_picture(scene, pose));
  const Comparison seen = compare(view, true_corners(scene, pose));
  EXPECT_EQ(seen.found, 1);
  EXPECT_LT(seen.worst, 0.1);
  EXPECT_LT(seen.mean, 0.03);
  expect_lattice(view);
}

TEST(FindBoard, FindsATiltedBoardInUnevenLightAndClutter) {
  const BoardScene scene{
      .lens = test_lens(), .noise = 2, .blur = 1.1, .shade = 0.4, .has_clutter = true};
  for (const auto& [about_x, about_y, about_z] :
       {std::array{0.7, 0.0, 0.4}, std::array{0.0, -0.75, 1.1}, std::array{0.5, 0.5, -0.6}}) {
    const Comparison seen = look(scene, board_at({0.01, -0.01, 0.4}, about_x, about_y, about_z));
    EXPECT_GT(seen.found, 0.9) << about_x << ' ' << about_y;
    EXPECT_LT(seen.worst, 0.1) << about_x << ' ' << about_y;
  }
}

TEST(FindBoard, TakesThePartOfABoardThatIsInThePicture) {
  const BoardScene scene{.lens = test_lens()};
  const Eigen::Isometry3d pose = board_at({0.12, 0.09, 0.25}, 0.3, 0.2, 0.1);
  const BoardView view = find_board(board_picture(scene, pose));
  const Comparison seen = compare(view, true_corners(scene, pose));
  EXPECT_GT(view.size(), 25U);
  EXPECT_LT(view.size(), 150U);  // of 176
  EXPECT_GT(seen.found, 0.8);    // the detector's ring of samples misses corners near the edge
  EXPECT_LT(seen.worst, 0.1);
}

TEST(FindBoard, SeesTheBoardAroundAHandThatHoldsIt) {
  const BoardScene scene{.lens = test_lens()};
  const Eigen::Isometry3d pose = board_at({0.01, -0.01, 0.35}, 0.5, 0.2, 0.7);
  Picture picture = board_picture(scene, pose);
  for (int v = 150; v < 370; ++v) {
    for (int u = 230; u < 370; ++u) {
      if (std::hypot((u - 300) / 70.0, (v - 260) / 110.0) < 1) {
        picture.samples[static_cast<std::size_t>(v * picture.width + u)] = 130;
      }
    }
  }
  const BoardView view = find_board(picture);
  const Comparison seen = compare(view, true_corners(scene, pose));
  EXPECT_GT(seen.found, 0.6);
  EXPECT_LT(seen.found, 0.85);
  EXPECT_LT(seen.mean,
            0.1);  // some at the hand's outline are a pixel off; the solver rejects them
  EXPECT_LT(seen.worst, 2);
  expect_lattice(view);
}

TEST(FindBoard, PutsEachCornerAtItsOwnPlace) {
  const BoardScene scene{.lens = test_lens()};
  const Eigen::Isometry3d pose = board_at({0, 0, 0.36}, 0.5, -0.3, 0.8);
  const BoardView view = find_board(board_picture(scene, pose));
  ASSERT_GT(view.size(), 100U);
  // A single rotation by quarters and a single shift must map all indices to the true ones.
  std::set<std::array<int, 2>> origins_by_turn[4];
  for (const BoardCorner& corner : view) {
    for (int row = 1; row < scene.rows; ++row) {
      for (int column = 1; column < scene.columns; ++column) {
        const Eigen::Vector3d on_board(column * scene.side, row * scene.side, 0);
        if ((shown(scene.lens, pose * on_board) - corner.pixel).norm() < 0.5) {
          std::array<int, 2> place{corner.column, corner.row};
          for (auto& origins : origins_by_turn) {
            origins.insert({column - place[0], row - place[1]});
            place = {-place[1], place[0]};
          }
        }
      }
    }
  }
  const auto is_one = [](const auto& origins) { return origins.size() == 1; };
  EXPECT_EQ(std::ranges::count_if(origins_by_turn, is_one), 1);
}

TEST(FindBoard, IsAsExactInALargePicture) {
  BoardScene scene{.lens = test_lens()};
  Intrinsics& lens = scene.lens.intrinsics;
  lens = {.width = 1640, .height = 1232, .fx = 1360, .fy = 1360, .cx = 822, .cy = 610};
  const Comparison seen = look(scene, board_at({0, 0, 0.36}, 0.3, 0.3, 0.2));
  EXPECT_GT(seen.found, 0.95);
  EXPECT_LT(seen.worst, 0.1);
}

TEST(FindBoard, SeesNoBoardWhereThereIsNone) {
  BoardScene scene{.lens = test_lens(), .noise = 4, .has_clutter = true};
  EXPECT_TRUE(find_board(board_picture(scene, board_at({2, 2, 0.4}, 0, 0, 0))).empty());
  EXPECT_TRUE(
      find_board(
          {.width = 640, .height = 480, .samples = std::vector<std::uint8_t>(640U * 480U, 128)})
          .empty());
  EXPECT_TRUE(
      find_board({.width = 4, .height = 4, .samples = std::vector<std::uint8_t>(16, 9)}).empty());
}

TEST(FindBoard, SeesNoBoardInAnotherPattern) {
  BoardScene few{.lens = test_lens(), .columns = 5, .rows = 5, .side = 0.03};  // 16 corners
  EXPECT_TRUE(find_board(board_picture(few, board_at({0, 0, 0.33}, 0, 0, 0, few))).empty());
}

}  // namespace
}  // namespace octurn
