#include "calibrate/object_view.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/calibrate/rendered_turn.hpp"

namespace octurn {
namespace {

using Eigen::Vector3d;

constexpr Intrinsics lens{
    .width = 120, .height = 80, .fx = 600, .fy = 600, .cx = 60, .cy = 40, .depth_unit = 0.00001};

/// A mask that takes everything nearer than 0.5 m for the object.
const ObjectView::Mask all_near{.plane = {.normal = -Vector3d::UnitZ(), .offset = -0.5},
                                .axis_point = Vector3d(0, 0, 0.4)};

/// A depth frame of the plane through (0, 0, 0.4) with this normal.
DepthFrame plane_frame(const Vector3d& normal) {
  DepthFrame frame{.width = lens.width, .height = lens.height, .depth = {}};
  for (int v = 0; v < lens.height; ++v) {
    for (int u = 0; u < lens.width; ++u) {
      const Vector3d ray((u - lens.cx) / lens.fx, (v - lens.cy) / lens.fy, 1);
      const double z = normal.z() * 0.4 / normal.dot(ray);
      frame.depth.push_back(
          static_cast<std::uint16_t>(z > 0 && z < 0.6 ? std::lround(z / lens.depth_unit) : 0));
    }
  }
  return frame;
}

TEST(ObjectView, ReadsPointsAsTheyAreAndNormalsOfTheirNeighbourhood) {
  const Vector3d normal = Vector3d(0.3, -0.2, -1).normalized();
  const ObjectView view(plane_frame(normal), lens, all_near);
  const auto readings = view.readings(3);
  ASSERT_GT(readings.size(), 500U);
  for (const SurfaceReading& reading : readings) {
    // Depth is rounded to 10 micrometres; normals are fitted to 5 x 5 pixels, 0.7 mm apart.
    EXPECT_NEAR(normal.dot(reading.point - Vector3d(0, 0, 0.4)), 0, 6e-6);
    EXPECT_LT(reading.normal.cross(normal).norm(), 0.003);
    EXPECT_GT(reading.normal.dot(normal), 0);
  }
}

TEST(ObjectView, FindsTheReadingWhereAPointIsSeen) {
  const ObjectView view(plane_frame(Vector3d(0.3, -0.2, -1).normalized()), lens, all_near);
  for (const SurfaceReading& reading : view.readings(5)) {
    const auto found = view.look_up(1.01 * reading.point);  // farther off along the same ray
    ASSERT_TRUE(found);
    EXPECT_EQ(found->point, reading.point);
  }
  EXPECT_FALSE(view.look_up({0.39, 0, 0.4}));   // beside the image
  EXPECT_FALSE(view.look_up({0, 0, -0.4}));     // behind the sensor
  EXPECT_FALSE(view.look_up({-0.04, 0, 0.4}));  // in the image's first column
}

TEST(ObjectView, ReadsNothingNearADepthEdge) {
  DepthFrame frame = plane_frame(-Vector3d::UnitZ());
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    if (i % 120 >= 60) {
      frame.depth[i] = static_cast<std::uint16_t>(frame.depth[i] + 2000);  // 2 cm farther off
    }
  }
  const ObjectView view(frame, lens, all_near);
  const auto at = [&](int u) {
    return view.look_up({(u - lens.cx) / lens.fx * 0.41, 0, 0.41}).has_value();
  };
  EXPECT_TRUE(at(57));
  EXPECT_FALSE(at(58));
  EXPECT_FALSE(at(61));
  EXPECT_TRUE(at(62));
}

TEST(ObjectView, ReadsNothingAtAGrazingAngle) {
  const auto tilted = [](double degrees) {
    const double angle = radians_from_degrees(degrees);
    const ObjectView view(plane_frame({0, std::sin(angle), -std::cos(angle)}), lens, all_near);
    return view.look_up({0, 0, 0.4}).has_value();
  };
  EXPECT_TRUE(tilted(74));   // its cosine is 0.28
  EXPECT_FALSE(tilted(77));  // 0.22
}

TEST(ObjectView, LeavesOutThePlatformAndWhatIsBesideIt) {
  const ObjectView::Mask mask{.plane = {.normal = Vector3d::UnitZ(), .offset = 0},
                              .axis_point = Vector3d(0.1, 0, 0),
                              .min_height = 0.005};
  EXPECT_FALSE(mask.contains({0.1, 0, 0.0049}));
  EXPECT_TRUE(mask.contains({0.1, 0, 0.0051}));
  EXPECT_TRUE(mask.contains({0.1, 0, 0.008}));
  EXPECT_TRUE(mask.contains({0.29, 0, 0.1}));
  EXPECT_FALSE(mask.contains({-0.11, 0, 0.1}));
  EXPECT_FALSE(mask.contains({0.1, 0, 0.5}));
}

TEST(ObjectView, IsEmptyWhereNothingIsTheObjects) {
  const DepthFrame nothing{.width = 120, .height = 80, .depth = std::vector<std::uint16_t>(9600)};
  const ObjectView view(nothing, lens, all_near);
  EXPECT_EQ(view.pixels(), 0);
  EXPECT_TRUE(view.readings(1).empty());
  EXPECT_FALSE(view.look_up({0, 0, 0.4}));
}

TEST(ObjectView, RefusesAnImageOfAnotherSize) {
  const DepthFrame other{.width = 121, .height = 80, .depth = std::vector<std::uint16_t>(9680)};
  EXPECT_THROW(ObjectView(other, lens, all_near), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
