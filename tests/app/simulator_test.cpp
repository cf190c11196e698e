// The simulated Kinect through OpenNI2, without noise, compared with computed geometry.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "app/simulated_frames.hpp"
#include "simulator/placed_object.hpp"
#include "simulator/simulated_kinect.hpp"
#include "simulator/simulator_object.hpp"
#include "turntable/simulated_turntable.hpp"

namespace octurn {
namespace {

constexpr double half_step = 0.5 + 0.03;  // raw readings; 0.03 as depths are rounded to 0.1 mm
constexpr const char* ideal = "octurn-simulator://?noise=0&pattern=0&misalignment=0";

TEST(Simulator, GivesOnlyDepthsOfWholeReadings) {
  const KinectFrame frame = frame_of("octurn-simulator://");
  int compared = 0;
  for (const std::uint16_t depth : frame.frame.depth) {
    if (depth != 0) {
      const double reading = std::round(1089.40 - 3454890.0 / depth);
      ASSERT_EQ(std::lround(3454890.0 / (1089.40 - reading)), depth);
      ++compared;
    }
  }
  EXPECT_GT(compared, 250000);
}

TEST(Simulator, TurnsToAWallAndBack) {
  const auto sensor = open_sensor(ideal);
  const KinectFrame before = frame_at(*sensor, 0);
  sensor->show_wall(0.7);
  const KinectFrame wall = frame_at(*sensor, 0);
  for (int v = 0; v < 480; v += 7) {
    for (int u = 0; u < 632; u += 7) {
      ASSERT_NEAR(reading_of_depth(wall.depth(u, v)), reading_of_depth(0.7), half_step);
    }
  }
  sensor->show_wall(std::nullopt);
  EXPECT_TRUE(frame_at(*sensor, 0).frame.depth == before.frame.depth);
}

TEST(Simulator, TurnsItsObjectOverAndBack) {
  const auto sensor = open_sensor(ideal);
  const KinectFrame before = frame_at(*sensor, 0);
  sensor->set_object_pose(1);
  const KinectFrame lies = frame_at(*sensor, 0);
  EXPECT_FALSE(lies.frame.depth == before.frame.depth);
  sensor->set_object_pose(0);
  EXPECT_TRUE(frame_at(*sensor, 0).frame.depth == before.frame.depth);
}

TEST(Simulator, LaysItsObjectOnThePlatform) {
  const Mesh object = simulator_object();
  for (int pose = 1; pose <= 3; ++pose) {
    const Eigen::Isometry3d lies = platform_from_object(object, pose);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3f& vertex : object.vertices) {
      box.extend(lies * vertex.cast<double>());
    }
    EXPECT_NEAR(box.min().z(), 0, 1e-9);
    EXPECT_LT(std::max(box.max().x(), box.max().y()), 0.14);
    EXPECT_GT(std::min(box.min().x(), box.min().y()), -0.14);
    EXPECT_GT(std::acos(std::clamp(lies.linear()(2, 2), -1.0, 1.0)), 1.5);  // radians from upright
  }
}

TEST(Simulator, SeesNothingInTheLastEightColumns) {
  const KinectFrame frame = frame_of(ideal);
  int seen = 0;
  for (int v = 0; v < 480; ++v) {
    seen += frame.is_seen(631, v) ? 1 : 0;
    for (int u = 632; u < 640; ++u) {
      ASSERT_FALSE(frame.is_seen(u, v)) << u << " " << v;
    }
  }
  EXPECT_EQ(seen, 480);
}

TEST(Simulator, SeesThePlatformWhereItIs) {
  const BoxesOnPlatform speck({{Eigen::Vector3d(-1, -1, 0), Eigen::Vector3d(1, 1, 1)}});
  const KinectFrame frame = frame_of(speck.uri());
  const Eigen::Isometry3d pose = nominal_platform_from_sensor();
  int compared = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 632; ++u) {
      const Eigen::Vector3d ray = pose.linear() * ray_of(u, v);
      const double depth = -pose.translation().z() / ray.z();
      const double radius = (pose.translation() + depth * ray).head<2>().norm();
      if (radius > 0.005 && radius < 0.148) {
        ASSERT_NEAR(reading_of_depth(frame.depth(u, v)), reading_of_depth(depth), half_step)
            << u << " " << v;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 20000);
}

TEST(Simulator, SeesThePlatformsEdgeAndTheTableBehind) {
  const KinectFrame frame = frame_of(ideal);
  const Eigen::Isometry3d pose = nominal_platform_from_sensor();
  // The rightmost point of the platform's top, where there is no shadow.
  const Eigen::Vector3d edge = pose.inverse() * Eigen::Vector3d(0.150, 0, 0);
  const auto u = static_cast<int>(575.8 * edge.x() / edge.z() + 320);
  const auto v = static_cast<int>(std::lround(575.8 * edge.y() / edge.z() + 240));

  EXPECT_NEAR(point_at(frame, u - 2, v).z(), 0, 0.002);
  EXPECT_LT(point_at(frame, u + 6, v).z(), -0.05);
}

/// The depth at which a ray meets the simulator's object, by sphere tracing; nothing if it misses
/// or only grazes the object. Metres.
std::optional<double> depth_of_object(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) {
  constexpr double close = 1e-6;
  constexpr double miss = 0.0015;  // nearer to the outline, a pixel may see past the object
  double depth = 0.3;
  for (int i = 0; i < 1000 && depth < 1.2; ++i) {
    const Eigen::Vector3d at = from + depth * ray;
    const double distance = simulator_object_distance(at);
    if (distance < close) {
      const double deeper = simulator_object_distance(at + 0.002 * ray / ray.norm());
      return deeper < -0.5 * 0.002 ? std::optional(depth) : std::nullopt;
    }
    if (distance < miss && simulator_object_distance(at + miss * ray) > distance) {
      return std::nullopt;
    }
    depth += distance / ray.norm();
  }
  return std::nullopt;
}

TEST(Simulator, SeesItsOwnObjectWhereItsDistanceSaysItIs) {
  constexpr double angle = radians_from_degrees(30);
  const KinectFrame frame = frame_of(ideal, angle);
  const Eigen::Isometry3d object_from_sensor =
      Eigen::AngleAxisd(-angle, Eigen::Vector3d::UnitZ()) * nominal_platform_from_sensor();
  int compared = 0;
  int beyond_half_a_step = 0;
  int unseen = 0;
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 632; ++u) {
      const auto depth = depth_of_object(object_from_sensor.translation(),
                                         object_from_sensor.linear() * ray_of(u, v));
      if (!depth) {
        continue;
      }
      if (!frame.is_seen(u, v)) {
        ++unseen;
        continue;
      }
      const double off = reading_of_depth(frame.depth(u, v)) - reading_of_depth(*depth);
      beyond_half_a_step += std::abs(off) > half_step ? 1 : 0;
      ++compared;
    }
  }
  EXPECT_GT(compared, 4000);
  EXPECT_LT(beyond_half_a_step, compared / 100);  // at creases, which the mesh rounds
  EXPECT_LT(unseen, compared / 5);                // in the object's own shadow
}

TEST(Simulator, ThrowsAShadowToTheLeftAsWideAsTheBaselineSays) {
  // A plate of 80 mm height stands across the view.
  const BoxesOnPlatform plate({{Eigen::Vector3d(-30, -2, 0), Eigen::Vector3d(30, 2, 80)}});
  const KinectFrame frame = frame_of(plate.uri());
  const Eigen::Isometry3d sensor_from_platform = nominal_platform_from_sensor().inverse();
  int compared = 0;
  for (const double height : {0.03, 0.04, 0.05, 0.06, 0.07}) {
    const Eigen::Vector3d left = sensor_from_platform * Eigen::Vector3d(-0.030, -0.002, height);
    const auto v = static_cast<int>(std::lround(575.8 * left.y() / left.z() + 240));
    auto u = static_cast<int>(std::ceil(575.8 * left.x() / left.z() + 320)) - 2;
    int dark = 0;
    for (; !frame.is_seen(u, v); --u) {
      ++dark;
    }
    const double behind = frame.depth(u, v);
    const double width = 575.8 * 0.075 * (1 / left.z() - 1 / behind);
    EXPECT_NEAR(dark + 1, width, 2) << "row " << v;  // a pixel on either side
    EXPECT_GT(width, 4);
    ++compared;

    const Eigen::Vector3d right = sensor_from_platform * Eigen::Vector3d(0.030, -0.002, height);
    const auto u_right = static_cast<int>(575.8 * right.x() / right.z() + 320);
    for (int aside = -2; aside < 20; ++aside) {
      EXPECT_TRUE(frame.is_seen(u_right + aside, v)) << aside;
    }
  }
  EXPECT_EQ(compared, 5);
}

/// The highest point seen above the platform.
Eigen::Vector3d top_of(const KinectFrame& frame) {
  Eigen::Vector3d top = Eigen::Vector3d::Zero();
  for (int v = 0; v < 480; ++v) {
    for (int u = 0; u < 640; ++u) {
      if (frame.is_seen(u, v)) {
        const Eigen::Vector3d point = point_at(frame, u, v);
        if (point.head<2>().norm() < 0.15 && point.z() > top.z()) {
          top = point;
        }
      }
    }
  }
  return top;
}

TEST(Simulator, TurnsCounterClockwiseSeenFromAbove) {
  // A post at x = 50 mm, and a low block on the other side, which keeps the centre on the axis.
  const BoxesOnPlatform post({{Eigen::Vector3d(40, -10, 0), Eigen::Vector3d(60, 10, 100)},
                              {Eigen::Vector3d(-60, -10, 0), Eigen::Vector3d(-40, 10, 20)}});
  const auto sensor = open_sensor(post.uri());
  for (const int degrees : {0, 45, 90, 200, 315}) {
    const double angle = radians_from_degrees(degrees);
    const Eigen::Vector3d top = top_of(frame_at(*sensor, angle));

    const Eigen::Vector3d expected(0.05 * std::cos(angle), 0.05 * std::sin(angle), 0.1);
    // Half the post's diagonal and a depth step.
    EXPECT_LT((top - expected).norm(), 0.017) << degrees;
  }
}

TEST(Simulator, FollowsATurntable) {
  const BoxesOnPlatform post({{Eigen::Vector3d(40, -10, 0), Eigen::Vector3d(60, 10, 100)},
                              {Eigen::Vector3d(-60, -10, 0), Eigen::Vector3d(-40, 10, 20)}});
  const auto sensor = open_sensor(post.uri());
  SimulatedTurntable turntable([&sensor](double angle) { sensor->show_angle(angle); }, 4);

  EXPECT_TRUE(turntable.move_to(200, {}));
  const auto arrived = std::chrono::steady_clock::now();
  TimedFrame timed = sensor->read({}).value();
  while (timed.time < arrived) {
    timed = sensor->read({}).value();
  }

  const Eigen::Vector3d top = top_of({timed.frame});
  EXPECT_LT((top - Eigen::Vector3d(0, 0.05, 0.1)).norm(), 0.017);
}

/// The depths of frame `number`, counted from 1.
std::vector<std::uint16_t> exposed(std::uint32_t seed, std::uint32_t number) {
  SimulatedKinect kinect(Scene(simulator_object()), seed, 1, 0);
  std::vector<std::uint16_t> depth(std::size_t{640} * 480);
  kinect.expose(0, number, depth);
  return depth;
}

// A busy machine may drop frames between the driver and a reader, so this test compares frames by
// number, without the driver.
TEST(Simulator, ShowsTheSameFramesForTheSameSeed) {
  const auto one = exposed(5, 1);
  EXPECT_TRUE(one == exposed(5, 1));
  EXPECT_TRUE(one != exposed(5, 2));
  EXPECT_TRUE(one != exposed(6, 1));
}

TEST(Simulator, KeepsWhatIsLargerThanTheView) {
  const BoxesOnPlatform room(
      {{Eigen::Vector3d(-3000, -3000, 0), Eigen::Vector3d(3000, 3000, 4000)}});
  const KinectFrame frame = frame_of(room.uri());

  // The sensor stands inside the room and looks at its floor, which is the platform's plane.
  EXPECT_NEAR(point_at(frame, 320, 400).z(), 0, 0.002);
  EXPECT_NEAR(point_at(frame, 20, 400).z(), 0, 0.002);
}

}  // namespace
}  // namespace octurn
