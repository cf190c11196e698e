#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/laser/lit_scene.hpp"
#include "octurn/model.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr int stops = 12;
constexpr Rgb red = {200, 40, 30};
constexpr Rgb blue = {20, 60, 180};
constexpr Rgb green = {10, 220, 10};
constexpr Rgb platform = {90, 90, 90};

/// A ball of two colours, and a small ball that hides a part of it at some stops.
const LitScene::Ball ball{.centre = {0, 0, 0.03}, .radius = 0.025};
const LitScene::Ball occluder{.centre = {0.04, 0, 0.055}, .radius = 0.01};

Rgb colour_of(const Vector3d& point) {
  if (std::abs((point - occluder.centre).norm() - occluder.radius) < 1e-5) {
    return green;
  }
  if (std::abs((point - ball.centre).norm() - ball.radius) < 1e-5) {
    return point.x() < 0 ? red : blue;
  }
  return platform;
}

/// Renders the picture of a stop. Each pixel's ray is undistorted by fixed-point iteration.
ColourPicture draw(const Scan& scan, double angle) {
  const Intrinsics& lens = scan.intrinsics;
  const Eigen::Isometry3d pose = object_from_sensor(scan.platform_from_sensor, angle);
  const LitScene scene{.balls = {ball, occluder}};
  ColourPicture picture{.width = lens.width, .height = lens.height};
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Eigen::Vector2d shown((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy);
      Eigen::Vector2d ideal = shown;
      for (int i = 0; i < 10; ++i) {
        const double square = ideal.squaredNorm();
        ideal = shown / (1 + scan.laser->k1 * square + scan.laser->k2 * square * square);
      }
      const Vector3d along = pose.linear() * ideal.homogeneous();
      const auto hit = scene.cast(pose.translation(), along);
      picture.pixels.push_back(hit ? colour_of(pose.translation() + hit->distance * along) : Rgb{});
    }
  }
  return picture;
}

struct Ball {
  std::vector<std::array<float, 3>> vertices = {};
  std::vector<std::array<std::uint32_t, 3>> triangles = {};
};

/// Adds a ball of 40 x 20 vertices to a mesh.
void add_ball(Ball& mesh, const LitScene::Ball& of) {
  constexpr std::uint32_t around = 40;
  constexpr std::uint32_t rows = 20;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t row = 0; row < rows; ++row) {
    for (std::uint32_t i = 0; i < around; ++i) {
      const double down = std::numbers::pi * (row + 0.5) / rows;
      const double turn = 2 * std::numbers::pi * i / around;
      const Vector3d point =
          1000 *
          (of.centre + of.radius * Vector3d(std::sin(down) * std::cos(turn),
                                            std::sin(down) * std::sin(turn), std::cos(down)));
      mesh.vertices.push_back({static_cast<float>(point.x()), static_cast<float>(point.y()),
                               static_cast<float>(point.z())});
      if (row > 0) {
        const std::uint32_t here = first + row * around + i;
        const std::uint32_t next = first + row * around + (i + 1) % around;
        mesh.triangles.push_back({here - around, here, next});
        mesh.triangles.push_back({here - around, next, next - around});
      }
    }
  }
}

Ball both_balls() {
  Ball mesh;
  add_ball(mesh, ball);
  add_ball(mesh, occluder);
  return mesh;
}

/// The colour in a model that is scaled by its brightest colour, the small ball's green, to 240.
Rgb brightened(const Rgb& painted) {
  Rgb bright{};
  std::ranges::transform(painted, bright.begin(), [](std::uint8_t level) {
    return static_cast<std::uint8_t>(std::lround(240.0 / green[1] * level));
  });
  return bright;
}

int difference(const Rgb& a, const Rgb& b) {
  int largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    largest = std::max(largest, std::abs(a[i] - b[i]));
  }
  return largest;
}

void put_png(const std::filesystem::path& file, std::span<const std::byte> png) {
  put(file, {reinterpret_cast<const char*>(png.data()), png.size()});
}

/// Writes a scan folder that has only the dark pictures.
Scan write_pictures(const std::filesystem::path& folder) {
  Scan scan = laser_rig(stops);
  for (const Shot& shot : scan.shots) {
    put_png(folder / shot.pictures[0], encode_rgb_png(draw(scan, shot.angle)));
  }
  return scan;
}

/// The colours of a mesh's vertices in the pictures of `write_pictures`.
std::vector<Rgb> colours_in_pictures(const Ball& mesh) {
  const TemporaryFolder folder;
  const Scan scan = write_pictures(folder.path());
  return vertex_colours(folder.path(), scan, {mesh.vertices, mesh.triangles});
}

/// Counts wrongly coloured vertices of the large ball's upper half, except near the colour seam.
int wrong_vertices(const Ball& mesh, const std::vector<Rgb>& colours) {
  int wrong = 0;
  for (std::size_t i = 0; i < 400; ++i) {
    const float x = mesh.vertices[i][0];
    if (std::abs(x) > 2) {  // a pixel covers 0.8 mm there, more at grazing angles
      wrong += difference(colours[i], brightened(x < 0 ? red : blue)) > 8 ? 1 : 0;
    }
  }
  return wrong;
}

TEST(VertexColours, AreThoseOfTheObjectWhereSomethingElseHidesItAtSomeStops) {
  const Ball mesh = both_balls();
  const std::vector<Rgb> colours = colours_in_pictures(mesh);

  ASSERT_EQ(colours.size(), mesh.vertices.size());
  // One in 50: a pixel at the small ball's rim shows both balls.
  EXPECT_LE(wrong_vertices(mesh, colours), 8);
}

TEST(VertexColours, AreTakenFromNeighboursWhereNoPictureSeesAVertex) {
  const Ball mesh = both_balls();
  const std::vector<Rgb> colours = colours_in_pictures(mesh);

  const std::size_t underside = 19 * 40 + 20;  // of the large ball, on its red side
  EXPECT_GT(colours[underside][0], colours[underside][2]);
  EXPECT_NE(colours[underside], (Rgb{255, 255, 255}));
}

TEST(VertexColours, AreGreyWherePicturesAre) {
  const TemporaryFolder folder;
  const Scan scan = laser_rig(stops);
  for (const Shot& shot : scan.shots) {
    const std::vector<std::uint8_t> grey(
        static_cast<std::size_t>(scan.intrinsics.width * scan.intrinsics.height), 77);
    put_png(folder.path() / shot.pictures[0],
            encode_grey_png(scan.intrinsics.width, scan.intrinsics.height, grey));
  }
  const Ball mesh = both_balls();

  const std::vector<Rgb> colours =
      vertex_colours(folder.path(), scan, {mesh.vertices, mesh.triangles});

  EXPECT_TRUE(std::ranges::all_of(colours, [](const Rgb& c) { return c == Rgb{240, 240, 240}; }));
}

TEST(VertexColours, OfDarkPicturesAreBrightenedByOneFactor) {
  const TemporaryFolder folder;
  const Scan scan = laser_rig(stops);
  for (const Shot& shot : scan.shots) {
    ColourPicture dark = draw(scan, shot.angle);
    for (Rgb& pixel : dark.pixels) {
      std::ranges::for_each(pixel, [](std::uint8_t& level) { level /= 10; });
    }
    put_png(folder.path() / shot.pictures[0], encode_rgb_png(dark));
  }
  const Ball mesh = both_balls();

  const std::vector<Rgb> colours =
      vertex_colours(folder.path(), scan, {mesh.vertices, mesh.triangles});

  // One grey level of the pictures is 11 levels of the model.
  const std::size_t red_side = 10 * 40 + 20;
  const std::size_t blue_side = 10 * 40;
  EXPECT_LE(difference(colours[red_side], brightened(red)), 11);
  EXPECT_LE(difference(colours[blue_side], brightened(blue)), 11);
}

TEST(VertexColours, OfBrightPicturesStayAsTheyAre) {
  const TemporaryFolder folder;
  const Scan scan = laser_rig(stops);
  const auto pixels = static_cast<std::size_t>(scan.intrinsics.width * scan.intrinsics.height);
  for (const Shot& shot : scan.shots) {
    put_png(folder.path() / shot.pictures[0],
            encode_rgb_png({.width = scan.intrinsics.width,
                            .height = scan.intrinsics.height,
                            .pixels = std::vector<Rgb>(pixels, Rgb{250, 9, 90})}));
  }
  const Ball mesh = both_balls();

  const std::vector<Rgb> colours =
      vertex_colours(folder.path(), scan, {mesh.vertices, mesh.triangles});

  EXPECT_TRUE(std::ranges::all_of(colours, [](const Rgb& c) { return c == Rgb{250, 9, 90}; }));
}

TEST(VertexColours, LeaveADamagedPictureOut) {
  const TemporaryFolder folder;
  const Scan scan = write_pictures(folder.path());
  put(folder.path() / scan.shots[3].pictures[0], "no PNG");
  const Ball mesh = both_balls();

  EXPECT_LE(
      wrong_vertices(mesh, vertex_colours(folder.path(), scan, {mesh.vertices, mesh.triangles})),
      8);
}

TEST(VertexColours, NeedAScanWithPictures) {
  Scan scan = laser_rig(1);
  scan.laser.reset();

  EXPECT_EQ(error_thrown_by([&] { vertex_colours(".", scan, {}); }).code(),
            ErrorCode::scan_malformed);
}

TEST(RgbPng, IsReadAsItWasWritten) {
  const ColourPicture picture{.width = 2, .height = 1, .pixels = {{1, 2, 3}, {250, 0, 9}}};

  EXPECT_EQ(decode_rgb_png("a.png", encode_rgb_png(picture), 2, 1).pixels, picture.pixels);
  EXPECT_EQ(error_thrown_by([&] { decode_rgb_png("a.png", encode_rgb_png(picture), 1, 2); }).code(),
            ErrorCode::snapshot_malformed);
}

}  // namespace
}  // namespace octurn
