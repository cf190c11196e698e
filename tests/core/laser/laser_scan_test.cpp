#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/laser/lit_scene.hpp"
#include "core/mesh/surface.hpp"
#include "io/sensor_json.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/reconstruct.hpp"
#include "octurn/register.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

// At the ball a pixel is 0.9 mm wide, and the laser line two pixels.
const LitScene ball_on_platform{.balls = {{.centre = {0.004, -0.003, 0.022}, .radius = 0.022}}};

/// The scan shared by all tests of this file, as drawing its pictures takes most of their time.
struct LaserScan {
  TemporaryFolder folder = {};
  Scan scan = write_laser_scan(folder.path(), ball_on_platform, 60);

  static const LaserScan& get() {
    static const LaserScan scan;
    return scan;
  }
  SnapshotSource snapshots() const {
    return stored_snapshots(folder.path(), read_scan(folder.path()));
  }
};

ReconstructOptions options(Method method, double leaf_size) {
  ReconstructOptions options{
      .method = method, .leaf_size = leaf_size, .root_size = 0.256, .clip = laser_rig(1).clip};
  fit_to_scan(options, LaserScan::get().scan);
  return options;
}

std::vector<Facet> model(const ReconstructOptions& options) {
  const SnapshotSource snapshots = LaserScan::get().snapshots();
  const std::unique_ptr<Reconstructor> reconstruction = make_reconstructor(options);
  reconstruction->add(snapshots);
  std::vector<Facet> facets;
  reconstruction->surface(snapshots, [&](std::span<const Facet> some) {
    facets.insert(facets.end(), some.begin(), some.end());
  });
  return facets;
}

/// Distances of the points that make surface from the true surface, sorted, metres.
std::vector<double> surface_errors(const SnapshotSource& snapshots, std::size_t step) {
  std::vector<double> errors;
  for (std::size_t stop = 0; stop < snapshots.count; stop += step) {
    const Snapshot snapshot = snapshots.read(stop);
    EXPECT_EQ(snapshot.strips.size(), 2U);
    for (const LineStrip& strip : snapshot.strips) {
      std::set<std::uint32_t> used;
      for (const LineStrip::Triangle& triangle : strip.to_next) {
        used.insert(triangle.begin(), triangle.end());
      }
      for (const std::uint32_t point : used) {
        errors.push_back(std::abs(ball_on_platform.distance(strip.points[point].cast<double>())));
      }
    }
  }
  std::ranges::sort(errors);
  return errors;
}

TEST(LaserScan, HasItsPointsOnTheSurface) {
  const std::vector<double> errors = surface_errors(LaserScan::get().snapshots(), 7);
  ASSERT_GT(errors.size(), 1000U);
  EXPECT_LT(errors[errors.size() / 2], 0.00005);        // a twentieth of a pixel
  EXPECT_LT(errors[errors.size() * 95 / 100], 0.0002);  // at grazing incidence and at line ends
}

/// As `surface_errors`, of a scan with stray light.
std::vector<double> errors_in(const StrayLight& stray) {
  const TemporaryFolder folder;
  write_laser_scan(folder.path(), ball_on_platform, 12, stray);
  return surface_errors(stored_snapshots(folder.path(), read_scan(folder.path())), 1);
}

TEST(LaserScan, HasItsPointsOnTheSurfacesOfRealMaterials) {
  constexpr double pixel = 0.0009;  // metres, at the ball
  const std::size_t clean = errors_in({}).size();
  for (const auto& [name, halo] : {std::pair{"plastic", on_plastic},
                                   {"plaster", on_plaster},
                                   {"paper", on_paper},
                                   {"sponge", on_sponge}}) {
    const std::vector<double> errors = errors_in({.halo = halo});
    ASSERT_GT(errors.size(), clean * 9 / 10) << name;
    EXPECT_LT(errors[errors.size() / 2], 0.05 * pixel) << name;
    EXPECT_LT(errors[errors.size() * 95 / 100], 0.2 * pixel) << name;
  }
}

/// Writes the pictures of a scan in colour, as of lasers of one colour.
/// @param share  of a laser's light in red, green and blue
void paint(const std::filesystem::path& folder, const Scan& scan,
           const std::array<double, 3>& share) {
  const Intrinsics& lens = scan.intrinsics;
  const auto read = [&](const std::string& file) {
    const std::string png = read_scan_file(folder / file);
    return decode_picture_png(file, std::as_bytes(std::span(png)), lens.width, lens.height);
  };
  for (const Shot& shot : scan.shots) {
    const Picture dark = read(shot.pictures.front());
    for (const std::string& file : shot.pictures) {
      const Picture lit = read(file);
      ColourPicture painted{.width = lens.width, .height = lens.height, .pixels = {}};
      for (std::size_t i = 0; i < lit.samples.size(); ++i) {
        Rgb pixel{};
        for (std::size_t channel = 0; channel < 3; ++channel) {
          // The room is of one colour that is not grey.
          const double room = dark.samples[i] + 7.0 * static_cast<double>(channel);
          pixel[channel] = static_cast<std::uint8_t>(std::clamp(
              std::lround(room + share[channel] * (lit.samples[i] - dark.samples[i])), 0L, 255L));
        }
        painted.pixels.push_back(pixel);
      }
      const auto png = encode_rgb_png(painted);
      put(folder / file, {reinterpret_cast<const char*>(png.data()), png.size()});
    }
  }
}

// In luminance the line has a third, or a ninth, of its light, which is then below eight levels.
TEST(LaserScan, FindsALaserInTheChannelOfItsColour) {
  const std::size_t in_white = errors_in({}).size();
  for (const auto& [name, share] :
       {std::pair{"red", std::array{0.35, 0.01, 0.0}}, {"blue", {0.0, 0.02, 0.35}}}) {
    const TemporaryFolder folder;
    const Scan scan = write_laser_scan(folder.path(), ball_on_platform, 12);
    paint(folder.path(), scan, share);
    const std::vector<double> errors =
        surface_errors(stored_snapshots(folder.path(), read_scan(folder.path())), 1);
    EXPECT_GT(errors.size(), in_white * 7 / 10) << name;
    EXPECT_LT(errors[errors.size() / 2], 0.0001) << name;
  }
}

// Halo, a line whose middle is white, and light that the ball throws on the platform's squares.
TEST(LaserScan, HasItsPointsWithinAFractionOfAPixelInStrayLight) {
  constexpr double pixel = 0.0009;  // metres, at the ball
  const std::vector<double> errors =
      errors_in({.exposure = 1.6, .halo = on_plaster, .indirect = 14});
  ASSERT_GT(errors.size(), errors_in({}).size() * 9 / 10);
  EXPECT_LT(errors[errors.size() / 2], 0.06 * pixel);
  EXPECT_LT(errors[errors.size() * 95 / 100], 0.25 * pixel);
  EXPECT_LT(errors[errors.size() * 99 / 100], pixel);
}

TEST(LaserScan, HasTrianglesBetweenLinesButNoneAcrossGaps) {
  const SnapshotSource snapshots = LaserScan::get().snapshots();
  const Snapshot snapshot = snapshots.read(3);
  const Snapshot next = snapshots.read(4);
  for (std::size_t laser = 0; laser < 2; ++laser) {
    const LineStrip& strip = snapshot.strips[laser];
    ASSERT_GT(strip.to_next.size(), 100U);
    EXPECT_NEAR(static_cast<double>(next.strips[laser].to_previous.size()),
                static_cast<double>(strip.to_next.size()),
                0.1 * static_cast<double>(strip.to_next.size()));
    for (const LineStrip::Triangle& triangle : strip.to_next) {
      Eigen::Vector3f middle = Eigen::Vector3f::Zero();
      for (const std::uint32_t point : triangle) {
        middle += strip.points[point] / 3;
      }
      // Chords of 3 mm lie up to 3^2 / (8 * 22) = 0.05 mm inside the ball. A triangle across the
      // gap from ball to platform would be farther off.
      EXPECT_LT(std::abs(ball_on_platform.distance(middle.cast<double>())), 0.0004);
    }
  }
}

// A degree is 0.8 pixels on an object of 8 cm. The pictures of the stops that close to the first do
// not exist, so reading one would fail.
TEST(LaserScan, JoinsALineWithThoseThatAreSomePixelsAway) {
  const TemporaryFolder folder;
  const Scan coarse = write_laser_scan(folder.path(), ball_on_platform, 8);
  Scan fine = coarse;
  const auto unread = [](double degrees) -> Shot {
    return {.pictures = {"none.png", "none.png", "none.png"},
            .angle = radians_from_degrees(degrees)};
  };
  fine.shots.insert(fine.shots.begin() + 1, unread(1));
  fine.shots.push_back(unread(359));

  const Snapshot snapshot = stored_snapshots(folder.path(), fine).read(0);

  const Snapshot expected = stored_snapshots(folder.path(), coarse).read(0);
  EXPECT_GT(snapshot.strips[0].points.size(), 2 * snapshot.strips[0].own_points);
  EXPECT_EQ(snapshot.strips[0].points.size(), expected.strips[0].points.size());
}

// Each pixel holds the first surface on its ray, never one behind it that other stops saw.
TEST(LaserScan, IsDrawnAsADepthCameraWouldHaveSeenIt) {
  const RegistrationTurn turn =
      laser_turn(LaserScan::get().folder.path(), read_scan(LaserScan::get().folder.path()));
  ASSERT_EQ(turn.angles.size(), 24U);
  const Intrinsics& lens = turn.intrinsics;
  std::vector<double> errors;
  std::size_t on_ball = 0;
  for (std::size_t stop = 0; stop < turn.angles.size(); stop += 5) {
    const DepthFrame frame = turn.read(stop);
    ASSERT_EQ(frame.depth.size(), static_cast<std::size_t>(lens.width * lens.height));
    const Eigen::Isometry3d pose = object_from_sensor(turn.platform_from_sensor, turn.angles[stop]);
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
      if (frame.depth[i] == 0) {
        continue;
      }
      const auto u = static_cast<double>(i % static_cast<std::size_t>(lens.width));
      const auto v = static_cast<double>(i / static_cast<std::size_t>(lens.width));
      const Eigen::Vector3d ray((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
      const auto hit = ball_on_platform.cast(pose.translation(), pose.linear() * ray);
      ASSERT_TRUE(hit);
      errors.push_back(std::abs(frame.depth[i] * lens.depth_unit - hit->distance));
      on_ball += (pose * (ray * hit->distance)).z() > 0.004 ? 1 : 0;
    }
  }
  EXPECT_GT(on_ball, 5 * 1000U);
  std::ranges::sort(errors);
  EXPECT_LT(errors[errors.size() / 2], 0.0001);
  EXPECT_LT(errors[errors.size() * 98 / 100], 0.0008);  // a pixel, at the ball's rim
}

TEST(LaserScan, MakesASolidOfTheBallsVolume) {
  const std::vector<Facet> facets = model(options(Method::solid, 0.001));
  MeshCheck check;
  check.add(facets);
  const double volume = 4.0 / 3 * std::numbers::pi * std::pow(22, 3);  // mm3
  EXPECT_TRUE(topology_of(facets).manifold);
  EXPECT_EQ(topology_of(facets).euler, 2);
  // The ball touches the platform at a point. Below it, out of sight of camera and laser, the
  // method fills in a foot.
  EXPECT_GT(check.volume_mm3(), 0.98 * volume);
  EXPECT_LT(check.volume_mm3(), 1.12 * volume);
  double worst = 0;
  for (const Facet& facet : facets) {
    for (const auto& corner : std::array(facet.corners)) {
      const Eigen::Vector3d point = Eigen::Vector3f(corner.data()).cast<double>() / 1000;
      if (facet.attributes != filled_in && point.z() > 0.02) {
        worst = std::max(worst, std::abs(ball_on_platform.distance(point)));
      }
    }
  }
  EXPECT_LT(worst, 0.0008);  // less than a voxel or a pixel
}

TEST(LaserScan, IsMetByTheLeavesOfTheIntersection) {
  const double leaf = 0.002;
  const std::vector<Facet> facets = model(options(Method::intersection, leaf));
  ASSERT_GT(facets.size(), 1000U);
  for (const Facet& facet : facets) {
    for (const auto& corner : std::array(facet.corners)) {
      const Eigen::Vector3d point = Eigen::Vector3f(corner.data()).cast<double>() / 1000;
      EXPECT_LT(std::abs(ball_on_platform.distance(point)), leaf * std::sqrt(3.0) + 0.0004);
    }
  }
}

TEST(LaserScan, HasTheSameBytesForAnyThreadsAndMemory) {
  for (const Method method : {Method::solid, Method::intersection}) {
    const ReconstructOptions alone = options(method, 0.001);
    ReconstructOptions several = alone;
    several.threads = 3;
    several.memory_limit = std::size_t{60} << 20U;
    EXPECT_TRUE(same_bytes(model(alone), model(several))) << to_string(method);
  }
}

TEST(LaserScan, NamesThePictureThatIsMissingOrDamaged) {
  TemporaryFolder folder;
  write_laser_scan(folder.path(), ball_on_platform, 3);
  const auto read = [&](std::size_t stop) {
    return error_thrown_by(
        [&] { stored_snapshots(folder.path(), read_scan(folder.path())).read(stop); });
  };
  const std::filesystem::path left = folder.path() / "snapshots" / "1-left.png";
  put(left, content_of(left).substr(0, 700));
  const Error damaged = read(1);
  std::filesystem::remove(left);
  const Error missing = read(1);

  EXPECT_EQ(damaged.code(), ErrorCode::snapshot_malformed);
  EXPECT_NE(std::string(damaged.what()).find("1-left.png"), std::string::npos) << damaged.what();
  EXPECT_EQ(missing.code(), ErrorCode::scan_missing);
  EXPECT_NE(std::string(missing.what()).find("1-left.png"), std::string::npos) << missing.what();
}

}  // namespace
}  // namespace octurn
