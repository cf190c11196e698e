#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "board_picture.hpp"
#include "octurn/lens.hpp"

namespace octurn {
namespace {

struct Hold {
  Eigen::Vector3d middle;
  double about_x;
  double about_y;
  double about_z;
};

/// Board poses as a person would hold it: tilted each way, and in each part of the picture.
std::vector<Hold> holds() {
  return {{{0, 0, 0.3}, 0.1, 0.0, 0.0},         {{0, 0, 0.34}, 0.55, 0.0, 0.1},
          {{0, 0, 0.34}, -0.55, 0.0, 1.5},      {{0, 0, 0.34}, 0.0, 0.55, 0.2},
          {{0, 0, 0.34}, 0.0, -0.55, 1.2},      {{-0.1, -0.07, 0.3}, 0.4, 0.3, 0.0},
          {{0.1, -0.07, 0.3}, 0.4, -0.3, 0.3},  {{-0.1, 0.07, 0.3}, -0.4, 0.3, 0.0},
          {{0.1, 0.07, 0.3}, -0.4, -0.3, -0.2}, {{0, 0.05, 0.24}, 0.2, 0.2, 0.8},
          {{0, -0.05, 0.24}, -0.2, 0.3, 0.0},   {{0.02, 0.0, 0.4}, 0.5, 0.5, 0.5}};
}

/// Views made of the true corners with noise.
std::vector<BoardView> views_of(const BoardScene& scene, const std::vector<Hold>& held,
                                double noise) {
  Random random(7);
  std::vector<BoardView> views;
  for (const Hold& hold : held) {
    const Eigen::Isometry3d pose =
        board_at(hold.middle, hold.about_x, hold.about_y, hold.about_z, scene);
    BoardView view;
    for (int row = 1; row < scene.rows; ++row) {
      for (int column = 1; column < scene.columns; ++column) {
        const Eigen::Vector2d pixel =
            shown(scene.lens, pose * Eigen::Vector3d(column * scene.side, row * scene.side, 0));
        if (pixel.x() > 4 && pixel.y() > 4 && pixel.x() < scene.lens.intrinsics.width - 5 &&
            pixel.y() < scene.lens.intrinsics.height - 5) {
          view.push_back(
              {.pixel = pixel + noise * Eigen::Vector2d(random.normal(), random.normal()),
               .column = column - 3,
               .row = row + 5});
        }
      }
    }
    views.push_back(view);
  }
  return views;
}

void expect_true(const LensReport& report, const CameraLens& truth, double focal_share,
                 double pixels, double k1) {
  const Intrinsics& lens = report.lens.intrinsics;
  EXPECT_NEAR(lens.fx, truth.intrinsics.fx, focal_share * truth.intrinsics.fx);
  EXPECT_NEAR(lens.fy, truth.intrinsics.fy, focal_share * truth.intrinsics.fy);
  EXPECT_NEAR(lens.cx, truth.intrinsics.cx, pixels);
  EXPECT_NEAR(lens.cy, truth.intrinsics.cy, pixels);
  EXPECT_NEAR(report.lens.k1, truth.k1, k1);
  EXPECT_NEAR(report.lens.k2, truth.k2, 4 * k1);
}

TEST(CalibrateLens, FindsTheLensFromExactCorners) {
  const BoardScene scene{.lens = test_lens()};
  const LensReport report = calibrate_lens(views_of(scene, holds(), 0), 640, 480);
  EXPECT_TRUE(report.accepted) << report.reason;
  expect_true(report, scene.lens, 1e-7, 1e-4, 1e-7);
  EXPECT_LT(report.rms, 1e-6);
}

TEST(CalibrateLens, FindsTheLensFromPictures) {
  const BoardScene scene{.lens = test_lens(), .shade = 0.4, .has_clutter = true};
  std::vector<BoardView> views;
  for (const Hold& hold : holds()) {
    views.push_back(find_board(
        board_picture(scene, board_at(hold.middle, hold.about_x, hold.about_y, hold.about_z),
                      static_cast<unsigned>(views.size()))));
  }
  const LensReport report = calibrate_lens(views, 640, 480);
  EXPECT_TRUE(report.accepted) << report.reason;
  expect_true(report, scene.lens, 0.001, 0.5, 0.003);
  EXPECT_LT(report.rms, 0.06);
}

TEST(CalibrateLens, KnowsHowWellItKnows) {
  const BoardScene scene{.lens = test_lens()};
  const LensReport report = calibrate_lens(views_of(scene, holds(), 0.1), 640, 480);
  ASSERT_TRUE(report.accepted) << report.reason;
  EXPECT_NEAR(report.rms, 0.1 * std::numbers::sqrt2, 0.005);
  const auto within = [](double found, double truth, double sigma) {
    EXPECT_LT(std::abs(found - truth), 3.5 * sigma);
  };
  const Intrinsics& lens = report.lens.intrinsics;
  const Intrinsics& sigma = report.sigma.intrinsics;
  within(lens.fx, scene.lens.intrinsics.fx, sigma.fx);
  within(lens.fy, scene.lens.intrinsics.fy, sigma.fy);
  within(lens.cx, scene.lens.intrinsics.cx, sigma.cx);
  within(lens.cy, scene.lens.intrinsics.cy, sigma.cy);
  within(report.lens.k1, scene.lens.k1, report.sigma.k1);
  within(report.lens.k2, scene.lens.k2, report.sigma.k2);
  EXPECT_GT(sigma.fx, 0.01);
  EXPECT_LT(sigma.fx, 0.5);
}

TEST(CalibrateLens, LeavesOutCornersThatAreWrong) {
  const BoardScene scene{.lens = test_lens()};
  std::vector<BoardView> views = views_of(scene, holds(), 0.05);
  for (std::size_t i = 0; i < views.size(); ++i) {
    views[i][10 * i % views[i].size()].pixel += Eigen::Vector2d(9, -6);
  }
  const LensReport report = calibrate_lens(views, 640, 480);
  EXPECT_TRUE(report.accepted) << report.reason;
  expect_true(report, scene.lens, 0.001, 0.5, 0.003);
}

void expect_refused(const LensReport& report, const std::string& because) {
  EXPECT_FALSE(report.accepted);
  EXPECT_NE(report.reason.find(because), std::string::npos) << report.reason;
}

TEST(CalibrateLens, RefusesTooFewViews) {
  const BoardScene scene{.lens = test_lens()};
  std::vector<BoardView> views = views_of(scene, holds(), 0.05);
  views.resize(4);
  views.resize(9);  // five more pictures that show no board
  expect_refused(calibrate_lens(views, 640, 480), "in 4 pictures");
  expect_refused(calibrate_lens({}, 640, 480), "in 0 pictures");
}

TEST(CalibrateLens, TakesNoViewWhoseCornersLieOnALine) {
  const BoardScene scene{.lens = test_lens()};
  std::vector<BoardView> views = views_of(scene, holds(), 0.05);
  for (BoardView& view : views) {
    std::erase_if(view, [](const BoardCorner& corner) { return corner.row > 7; });
  }
  expect_refused(calibrate_lens(views, 640, 480), "in 0 pictures");
}

TEST(CalibrateLens, RefusesBoardsThatAreParallel) {
  const BoardScene scene{.lens = test_lens()};
  std::vector<Hold> held = holds();
  for (Hold& hold : held) {
    hold.about_x *= 0.1;
    hold.about_y *= 0.1;
  }
  expect_refused(calibrate_lens(views_of(scene, held, 0.05), 640, 480), "nearly parallel");
}

TEST(CalibrateLens, RefusesAPictureOfWhichMuchWasNotReached) {
  const BoardScene scene{.lens = test_lens(), .columns = 9, .rows = 7};
  std::vector<Hold> held = holds();
  for (Hold& hold : held) {
    hold.middle = {0, 0, 0.45};
  }
  expect_refused(calibrate_lens(views_of(scene, held, 0.02), 640, 480), "% of the picture only");
}

TEST(CalibrateLens, RefusesABoardThatIsNotFlat) {
  const BoardScene scene{.lens = test_lens()};
  expect_refused(calibrate_lens(views_of(scene, holds(), 0.9), 640, 480), "not flat");
}

// A file would be refused that has such a lens, and every later start with it.
TEST(CalibrateLens, RefusesADistortionThatNoLensHas) {
  constexpr double longer = 20;
  BoardScene scene{.lens = test_lens()};
  scene.lens.intrinsics.fx *= longer;
  scene.lens.intrinsics.fy *= longer;
  scene.lens.k1 = 150;
  scene.lens.k2 = 0;
  std::vector<Hold> held = holds();
  for (Hold& hold : held) {
    hold.middle.z() *= longer;
  }
  expect_refused(calibrate_lens(views_of(scene, held, 0), 640, 480), "bends a picture that much");
}

}  // namespace
}  // namespace octurn
