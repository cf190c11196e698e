#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "mesh/model_colours.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/stl.hpp"
#include "octurn/units.hpp"
#include "support/ball_scan.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr Intrinsics lens;
constexpr int rings = 24;
constexpr int sectors = 48;

std::array<float, 3> ball_corner(int ring, int sector) {
  const double polar = std::numbers::pi * ring / rings;
  const double around = 2 * std::numbers::pi * (sector % sectors) / sectors;
  const Vector3d place =
      ball_centre + ball_radius * Vector3d(std::sin(polar) * std::cos(around),
                                           std::sin(polar) * std::sin(around), std::cos(polar));
  return {static_cast<float>(mm_from_metres(place.x())),
          static_cast<float>(mm_from_metres(place.y())),
          static_cast<float>(mm_from_metres(place.z()))};
}

class ViewColours : public testing::Test {
 protected:
  ViewColours() {
    std::vector<Facet> facets;
    for (int ring = 0; ring < rings; ++ring) {
      for (int sector = 0; sector < sectors; ++sector) {
        const auto a = ball_corner(ring, sector);
        const auto b = ball_corner(ring + 1, sector);
        const auto c = ball_corner(ring + 1, sector + 1);
        const auto d = ball_corner(ring, sector + 1);
        facets.push_back({.corners = {a, b, c}});
        facets.push_back({.corners = {a, c, d}});
      }
    }
    put(folder_.path() / "Scan.stl", stl_text(facets));
  }

  FacetFile model() const { return FacetFile(folder_.path() / "Scan.stl"); }

  TemporaryFolder folder_;
};

/// At the size of a Kinect's image: half a pixel of a smaller one is 8 mm deep on a steep surface.
SnapshotSource whole_ball_scan(std::size_t count) {
  return {.count = count, .read = [count](std::size_t stop) {
            return ball_snapshot(ball_angle(stop, count), lens);
          }};
}

/// Nothing hides a part of a ball from a sensor but the ball: the angle at which a ray meets it
/// decides.
TEST_F(ViewColours, CountTheSnapshotsThatSawEachVertexOfABall) {
  constexpr std::size_t stops = 8;
  const auto colours = view_colours(model(), whole_ball_scan(stops));
  const VertexTable table(model());
  ASSERT_EQ(colours.size(), table.vertices().size());

  std::vector<int> compared(colours_of_views.size());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const Vector3d place =
        Eigen::Map<const Eigen::Vector3f>(table.vertices()[i].data()).cast<double>() *
        metres_from_mm(1);
    int surely = 0;
    int perhaps = 0;
    for (std::size_t stop = 0; stop < stops; ++stop) {
      const Vector3d eye =
          object_from_sensor(ball_sensor_pose(), ball_angle(stop, stops)).translation();
      const double cosine = (place - ball_centre).normalized().dot((eye - place).normalized());
      surely += cosine > 0.3 ? 1 : 0;  // 2.5 degrees around 75, by which normals of facets are off
      perhaps += cosine > 0.2 ? 1 : 0;
    }
    const auto views = static_cast<std::size_t>(std::min(surely, 5));
    if (surely == perhaps) {
      ++compared[views];
      EXPECT_EQ(colours[i], colours_of_views[views]) << place.transpose();
    }
  }
  EXPECT_GT(*std::ranges::max_element(compared), 100);
  EXPECT_GT(std::ranges::count_if(compared, [](int vertices) { return vertices > 10; }), 3);
}

TEST_F(ViewColours, CountNoSnapshotInWhichSomethingElseIsSeenThere) {
  const SnapshotSource hidden{.count = 8, .read = [](std::size_t stop) {
                                Snapshot snapshot = ball_snapshot(ball_angle(stop, 8), lens);
                                for (std::uint16_t& reading : snapshot.frame.depth) {
                                  reading =
                                      static_cast<std::uint16_t>(reading > 100 ? reading - 100 : 0);
                                }
                                return snapshot;
                              }};
  const auto colours = view_colours(model(), hidden);  // 10 mm in front of the ball
  EXPECT_EQ(std::ranges::count(colours, colours_of_views[0]), std::ssize(colours));
}

TEST_F(ViewColours, OfALaidModelAreThoseOfTheObjectAsItStood) {
  const ModelEdits edits{
      .lay = LaidSide{.down = Vector3d(0.6, 0, 0.8), .point = {0.01, 0.02, 0.03}}, .scale = 2.5};
  const Eigen::Affine3d laid = model_from_object(edits);
  std::vector<Facet> facets;
  model().read([&](std::span<const Facet> block) {
    for (Facet facet : block) {
      auto corners = facet.corners;
      for (auto& corner : corners) {
        const Vector3d place =
            laid *
            (Eigen::Map<const Eigen::Vector3f>(corner.data()).cast<double>() * metres_from_mm(1));
        for (std::size_t axis = 0; axis < 3; ++axis) {
          corner[axis] = static_cast<float>(mm_from_metres(place[static_cast<Eigen::Index>(axis)]));
        }
      }
      facet.corners = corners;
      facets.push_back(facet);
    }
  });
  put(folder_.path() / "Laid.stl", stl_text(facets));
  const auto as_scanned = view_colours(model(), whole_ball_scan(8));
  const auto colours =
      view_colours(FacetFile(folder_.path() / "Laid.stl"), whole_ball_scan(8), edits);
  ASSERT_EQ(colours.size(), as_scanned.size());
  std::size_t equal = 0;
  for (std::size_t i = 0; i < colours.size(); ++i) {
    equal += colours[i] == as_scanned[i] ? 1 : 0;
  }
  EXPECT_GT(equal, colours.size() * 99 / 100);  // rounding decides at the limits of a view
}

TEST_F(ViewColours, EndWhenTheyAreStopped) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW(view_colours(model(), ball_scan(2), {}, stop.get_token()), Stopped);
}

/// A triangle that faces the sensor, and a snapshot that sees it 20 mm too far away.
std::vector<Rgb> colours_at(double distance) {
  const TemporaryFolder folder;
  const auto corner = [distance](double x, double y) {
    return std::array{static_cast<float>(mm_from_metres(x)), static_cast<float>(mm_from_metres(y)),
                      static_cast<float>(mm_from_metres(distance))};
  };
  const std::vector<Facet> facets{{.corners = {corner(0, 0), corner(0, 0.05), corner(0.05, 0)}}};
  put(folder.path() / "Scan.stl", stl_text(facets));
  const auto depth = static_cast<std::uint16_t>(std::lround((distance + 0.02) / lens.depth_unit));
  const DepthFrame frame{.width = lens.width,
                         .height = lens.height,
                         .depth = std::vector<std::uint16_t>(std::size_t{640} * 480, depth)};
  return view_colours(FacetFile(folder.path() / "Scan.stl"),
                      {.count = 1, .read = [frame](std::size_t) {
                         return Snapshot{.frame = frame, .intrinsics = lens};
                       }});
}

TEST(ViewColoursOfASpace, TakeTheNoiseAtItsDistance) {
  EXPECT_EQ(colours_at(0.75), std::vector<Rgb>(3, colours_of_views[0]));
  EXPECT_EQ(colours_at(3), std::vector<Rgb>(3, colours_of_views[1]));
}

}  // namespace
}  // namespace octurn
