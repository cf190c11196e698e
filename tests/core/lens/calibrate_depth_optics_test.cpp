#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "board_picture.hpp"
#include "octurn/lens.hpp"

namespace octurn {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A sensor that is not its data sheet's, before a board that is not as told.
struct TrueSensor {
  SensorOptics optics = {.fx = 590.5,
                         .fy = 590.5,
                         .cx = 332,
                         .cy = 246,
                         .k1 = -0.06,
                         .depth_scale = 1.012,
                         .depth_offset_per_m = 0.002};
  Vector2d shift = infrared_shift;
  double corner_noise = 0.3;  // pixels
  double side = 0.015;        // metres, of the board's squares
};

CameraLens infrared_lens(const TrueSensor& sensor) {
  const SensorOptics& in = sensor.optics;
  return {.intrinsics = {.width = 640,
                         .height = 480,
                         .fx = in.fx,
                         .fy = in.fy,
                         .cx = in.cx + sensor.shift.x(),
                         .cy = in.cy + sensor.shift.y()},
          .k1 = in.k1,
          .k2 = in.k2};
}

BoardScene scene_of(const TrueSensor& sensor) {
  return {.lens = infrared_lens(sensor), .side = sensor.side};
}

/// Boards half a metre and more away, as a Kinect measures them: tilted each way, and in each part
/// of the picture.
std::vector<Eigen::Isometry3d> boards_of(const TrueSensor& sensor) {
  struct Hold {
    Vector3d middle;
    double about_x = 0;
    double about_y = 0;
    double about_z = 0;
  };
  const std::vector<Hold> holds = {
      {{0, 0, 0.55}, 0.1, 0.0, 0.0},           {{0, 0, 0.58}, 0.8, 0.0, 0.1},
      {{0, 0, 0.58}, -0.8, 0.0, 1.5},          {{0, 0, 0.58}, 0.0, 0.8, 0.2},
      {{0, 0, 0.58}, 0.0, -0.8, 1.2},          {{-0.18, -0.12, 0.55}, 0.5, 0.5, 0.0},
      {{0.16, -0.12, 0.55}, 0.5, -0.5, 0.3},   {{-0.18, 0.12, 0.55}, -0.5, 0.5, 0.0},
      {{0.16, 0.12, 0.55}, -0.5, -0.5, -0.2},  {{-0.2, 0, 0.55}, 0.2, 0.7, 1.5},
      {{0.18, 0, 0.55}, 0.2, -0.7, 1.5},       {{0, 0.14, 0.52}, 0.7, 0.2, 0.8},
      {{0, -0.14, 0.52}, -0.7, 0.3, 0.0},      {{0.02, 0.0, 0.7}, 0.5, 0.5, 0.5},
      {{0.05, 0.05, 0.68}, -0.6, 0.4, 0.2},    {{-0.05, 0.05, 0.66}, 0.5, -0.6, 1.0},
      {{-0.18, -0.12, 0.55}, -0.6, -0.4, 1.5}, {{0.16, -0.12, 0.55}, -0.6, 0.4, 1.4},
      {{-0.18, 0.12, 0.55}, 0.6, -0.4, 1.6},   {{0.16, 0.12, 0.55}, 0.6, 0.4, 1.5},
      {{0.1, 0, 0.5}, 0.8, 0.1, 0.8},          {{-0.1, 0, 0.5}, -0.8, 0.1, 0.7},
      {{0, 0.08, 0.5}, 0.1, 0.85, 0.8},        {{0, -0.08, 0.5}, 0.1, -0.85, 0.7}};
  std::vector<Eigen::Isometry3d> boards;
  for (const Hold& hold : holds) {
    boards.push_back(
        board_at(hold.middle, hold.about_x, hold.about_y, hold.about_z, scene_of(sensor)));
  }
  return boards;
}

/// The fixed pattern of a Kinect: 0.8 steps of disparity, correlated over some 50 pixels.
double pattern(double u, double v, double inverse_depth) {
  const double near = std::sin(u / 31 + 1) * std::cos(v / 37) + std::sin(u / 53 - v / 41 + 2);
  const double slope = std::cos(u / 43 + v / 29);
  return (0.8 * near + 0.5 * (inverse_depth - 1.5) * slope) / 345.489;
}

DepthFrame depth_of(const TrueSensor& sensor, const Eigen::Isometry3d& board) {
  const BoardScene scene = scene_of(sensor);
  const Eigen::Isometry3d board_from_camera = board.inverse();
  DepthFrame frame{.width = 640, .height = 480};
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const Vector2d ray = ray_at(scene.lens, u + sensor.shift.x(), v + sensor.shift.y());
      const Vector3d from = board_from_camera.translation();
      const Vector3d way = board_from_camera.linear() * ray.homogeneous();
      const double depth = -from.z() / way.z();
      const Vector2d met = intersect_board(scene, board_from_camera, ray);
      const bool is_board = met.x() > -1 && met.y() > -1 && met.x() < 18 && met.y() < 13;
      const double inverse = is_board ? 1 / depth : 1 / 2.0;
      const double reported = sensor.optics.depth_scale * inverse -
                              sensor.optics.depth_offset_per_m + pattern(u, v, inverse);
      frame.depth.push_back(static_cast<std::uint16_t>(std::lround(1e4 / reported)));
    }
  }
  return frame;
}

/// A view of the true corners with noise.
BoardView corners_of(const TrueSensor& sensor, const Eigen::Isometry3d& board, Random& random) {
  const BoardScene scene = scene_of(sensor);
  BoardView view;
  for (int row = 1; row < scene.rows; ++row) {
    for (int column = 1; column < scene.columns; ++column) {
      const Vector2d pixel =
          shown(scene.lens, board * Vector3d(column * scene.side, row * scene.side, 0));
      if (pixel.x() > 8 && pixel.y() > 8 && pixel.x() < 631 && pixel.y() < 471) {
        const double across = random.normal();  // in this order with any compiler
        const double down = random.normal();
        view.push_back({.pixel = pixel + sensor.corner_noise * Vector2d(across, down),
                        .column = column,
                        .row = row});
      }
    }
  }
  return view;
}

DepthOpticsReport calibrated(const TrueSensor& sensor) {
  Random random(5);
  std::vector<DepthBoardView> views;
  for (const Eigen::Isometry3d& board : boards_of(sensor)) {
    const BoardView corners = corners_of(sensor, board, random);
    views.push_back(
        {.corners = corners, .depths = board_depths(corners, depth_of(sensor, board), {})});
  }
  return calibrate_depth_optics(views, 640, 480, 0.015);
}

/// How much too large things are that stand 0.6 m away, and are measured with these optics.
double scale_error(const SensorOptics& found, const SensorOptics& truth) {
  const double reported = truth.depth_scale / 0.6 - truth.depth_offset_per_m;
  return found.depth_scale / (reported + found.depth_offset_per_m) / 0.6 - 1;
}

void expect_optics(const DepthOpticsReport& report, const SensorOptics& truth, double share,
                   double pixels) {
  ASSERT_TRUE(report.lens.accepted) << report.lens.reason;
  const SensorOptics& found = report.optics.value;
  EXPECT_NEAR(found.fx, truth.fx, share * truth.fx);
  EXPECT_EQ(std::lround(100 * found.fx), std::lround(100 * found.fy));
  EXPECT_NEAR(found.cx, truth.cx, pixels);
  EXPECT_NEAR(found.cy, truth.cy, pixels);
  EXPECT_NEAR(found.k1, truth.k1, 0.02);
  EXPECT_NEAR(scale_error(found, truth), 0, share);
}

// With the noise of corners that dots leave, a focal length has a sigma of 0.1 %.
TEST(CalibrateDepthOptics, FindsLensScaleAndOffset) {
  const TrueSensor sensor;
  const DepthOpticsReport report = calibrated(sensor);
  expect_optics(report, sensor.optics, 0.002, 1.5);
  EXPECT_LT(report.optics.sigma.depth_scale, 0.003);
  EXPECT_GT(report.optics.sigma.depth_scale, 0.002);
}

TEST(CalibrateDepthOptics, IsNoMoreCertainOfTheScaleThanAPrintedBoardIs) {
  const DepthOpticsReport report = calibrated({.corner_noise = 0.01});
  ASSERT_TRUE(report.lens.accepted) << report.lens.reason;
  EXPECT_GE(report.optics.sigma.depth_scale, 0.002);
  EXPECT_LT(report.optics.sigma.depth_scale, 0.0022);
}

// A driver may crop other rows of the infrared picture than are known from the literature.
TEST(CalibrateDepthOptics, MeasuresTheShiftOfTheInfraredPicture) {
  const TrueSensor sensor{.shift = Vector2d(4.8, -0.1)};
  const DepthOpticsReport report = calibrated(sensor);
  expect_optics(report, sensor.optics, 0.003, 1.5);
  EXPECT_NEAR(report.shift.y(), -0.1, 0.4);
  EXPECT_NEAR(report.shift.x(), 4.8, 0.4);
}

// Nothing but a ruler can tell: the scale is wrong by as much, and the focal length is not.
TEST(CalibrateDepthOptics, TakesTheSizeOfTheSquaresAsTold) {
  const TrueSensor sensor{.side = 0.015 * 0.995};
  const DepthOpticsReport report = calibrated(sensor);
  ASSERT_TRUE(report.lens.accepted) << report.lens.reason;
  EXPECT_NEAR(report.optics.value.fx, sensor.optics.fx, 0.002 * sensor.optics.fx);
  EXPECT_NEAR(scale_error(report.optics.value, sensor.optics), 0.005, 0.002);
}

TEST(CalibrateDepthOptics, RefusesCornersThatNoLensShows) {
  const DepthOpticsReport report = calibrated({.corner_noise = 1});
  EXPECT_FALSE(report.lens.accepted);
  EXPECT_NE(report.lens.reason.find("not flat"), std::string::npos) << report.lens.reason;
}

TEST(CalibrateDepthOptics, RefusesABoardWithoutDepths) {
  const TrueSensor sensor;
  Random random(5);
  std::vector<DepthBoardView> views;
  for (const Eigen::Isometry3d& board : boards_of(sensor)) {
    views.push_back({.corners = corners_of(sensor, board, random)});
  }
  const DepthOpticsReport report = calibrate_depth_optics(views, 640, 480, 0.015);
  EXPECT_FALSE(report.lens.accepted);
  EXPECT_NE(report.lens.reason.find("depth"), std::string::npos) << report.lens.reason;
}

/// Lights a picture with projected dots: one in each 3 x 3 pixels, of unequal brightness.
/// @param ambient  other light, times a dot's
Picture with_dots(const Picture& picture, double ambient) {
  Picture lit = picture;
  Random random(3);
  std::vector<Vector2d> dots;
  std::vector<double> light(picture.samples.size(), ambient);
  for (int v = 0; v < picture.height; v += 3) {
    for (int u = 0; u < picture.width; u += 3) {
      const double across = 3 * random.uniform();  // in this order with any compiler
      const double down = 3 * random.uniform();
      const Vector2d dot(u + across, v + down);
      const double bright = 1 + random.uniform();
      for (int y = v - 2; y < v + 5; ++y) {
        for (int x = u - 2; x < u + 5; ++x) {
          if (x >= 0 && y >= 0 && x < picture.width && y < picture.height) {
            light[static_cast<std::size_t>(y * picture.width + x)] +=
                bright * std::exp(-(Vector2d(x, y) - dot).squaredNorm() / 1.2);
          }
        }
      }
    }
  }
  for (std::size_t i = 0; i < light.size(); ++i) {
    lit.samples[i] = static_cast<std::uint8_t>(
        std::clamp(std::lround(0.5 * light[i] * picture.samples[i]), 0L, 255L));
  }
  return lit;
}

// Dots are the only light, and a board's edges are where dots end. Each corner is within half a
// pixel (standard deviation), and no false one is found.
TEST(FindDottedBoard, FindsCornersWhereDotsAreTheOnlyLight) {
  const TrueSensor sensor;
  const std::vector<Eigen::Isometry3d> boards = boards_of(sensor);
  for (const std::size_t number : {0U, 1U, 4U, 6U, 20U}) {
    const BoardScene scene = scene_of(sensor);
    const Picture picture = with_dots(board_picture(scene, boards[number]), 0.0);
    const BoardView corners = find_dotted_board(picture);
    const std::vector<Vector2d> truth = true_corners(scene, boards[number]);
    EXPECT_GT(corners.size(), truth.size() * 9 / 10) << "board " << number;
    EXPECT_LE(corners.size(), truth.size()) << "board " << number;
    double squares = 0;
    for (const BoardCorner& corner : corners) {
      double least = 1e9;
      for (const Vector2d& pixel : truth) {
        least = std::min(least, (pixel - corner.pixel).squaredNorm());
      }
      squares += least;
    }
    EXPECT_LT(std::sqrt(squares / static_cast<double>(2 * corners.size())), 0.5)
        << "board " << number;
  }
}

TEST(FindDottedBoard, FindsNoneInDotsAlone) {
  Picture wall{.width = 640, .height = 480, .samples = {}};
  wall.samples.assign(std::size_t{640} * 480, 120);
  EXPECT_TRUE(find_dotted_board(with_dots(wall, 0.0)).empty());
}

}  // namespace
}  // namespace octurn
