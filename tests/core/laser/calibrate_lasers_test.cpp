#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/laser/lit_scene.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {
namespace {

const LitScene two_balls{.balls = {{.centre = {0.014, -0.003, 0.022}, .radius = 0.022},
                                   {.centre = {-0.022, 0.006, 0.013}, .radius = 0.013}}};

constexpr double tenth_of_a_pixel = 1e-4;  // metres at the object, in pictures of 200 x 150 pixels

/// A scan's pictures, which can be solved from an initial rig that differs from the true one.
class Turn {
 public:
  explicit Turn(const LitScene& scene) : truth_(write_laser_scan(folder_.path(), scene, 40)) {}

  static const Turn& of_two_balls() {
    static const Turn turn(two_balls);
    return turn;
  }

  const Scan& truth() const { return truth_; }
  LaserCalibration solve(const Scan& told, int threads = 1) const {
    return calibrate_lasers(folder_.path(), told, threads);
  }

 private:
  TemporaryFolder folder_ = {};
  Scan truth_;
};

/// Returns the laser turned in its holder, about the vertical axis through its source.
Laser turned(const Laser& laser, double degrees) {
  const Eigen::Vector3d up = laser_rig_pose().linear().transpose() * Eigen::Vector3d::UnitZ();
  Laser other = laser;
  other.normal = Eigen::AngleAxisd(radians_from_degrees(degrees), up) * laser.normal;
  other.distance = other.normal.dot(*laser.source);
  return other;
}

/// The largest distance between two planes within 4 cm of the axis, metres.
double distance_at_object(const Laser& a, const Laser& b) {
  const Eigen::Isometry3d sensor_from_platform = laser_rig_pose().inverse();
  double largest = 0;
  for (const double x : {-0.04, 0.04}) {
    for (const double z : {0.0, 0.04}) {
      const Eigen::Vector3d point = sensor_from_platform * Eigen::Vector3d(x, x / 2, z);
      largest = std::max(
          largest, std::abs(a.normal.dot(point) - a.distance - (b.normal.dot(point) - b.distance)));
    }
  }
  return largest;
}

/// The angle between two planes about the vertical axis.
double degrees_between(const Laser& a, const Laser& b) {
  const auto heading = [](const Laser& laser) {
    const Eigen::Vector3d normal = laser_rig_pose().linear() * laser.normal;
    return std::atan2(normal.y(), normal.x());
  };
  return degrees_from_radians(std::abs(heading(a) - heading(b)));
}

TEST(CalibrateLasers, LeavesWhatIsRightAsItIs) {
  const Scan& truth = Turn::of_two_balls().truth();
  const LaserCalibration found = Turn::of_two_balls().solve(truth);

  ASSERT_TRUE(found.report.accepted) << found.report.reason;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(distance_at_object(found.lasers[i], truth.laser->lasers[i]), tenth_of_a_pixel);
  }
  EXPECT_LT(found.report.shift, 2e-4);  // metres, the sigma of a told pose
}

TEST(CalibrateLasers, FindsPlanesThatWereTurnedInTheirHolders) {
  const Scan& truth = Turn::of_two_balls().truth();
  Scan told = truth;
  told.laser->lasers[0] = turned(truth.laser->lasers[0], -0.1);
  told.laser->lasers[1] = turned(truth.laser->lasers[1], 0.1);
  ASSERT_GT(distance_at_object(told.laser->lasers[0], truth.laser->lasers[0]), 4e-4);

  const LaserCalibration found = Turn::of_two_balls().solve(told);

  ASSERT_TRUE(found.report.accepted) << found.report.reason;
  EXPECT_TRUE(found.moved_a_plane);
  EXPECT_LT(found.report.after, found.report.before / 3);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(distance_at_object(found.lasers[i], truth.laser->lasers[i]), tenth_of_a_pixel);
  }
}

TEST(CalibrateLasers, FindsAPoseThatWasToldWrong) {
  const Scan& truth = Turn::of_two_balls().truth();
  Scan told = truth;
  told.platform_from_sensor =
      Eigen::Translation3d(0.003, -0.002, 0.004) *
      Eigen::AngleAxisd(radians_from_degrees(0.7), Eigen::Vector3d::UnitX()) *
      truth.platform_from_sensor;

  const LaserCalibration found = Turn::of_two_balls().solve(told);

  ASSERT_TRUE(found.report.accepted) << found.report.reason;
  const Eigen::Isometry3d left =
      found.report.platform_from_sensor * truth.platform_from_sensor.inverse();
  // The error of the pose, except for a rotation about the axis: compared on the axis, 3 cm up.
  const Eigen::Vector3d up = left * Eigen::Vector3d(0, 0, 0.03);
  EXPECT_LT(up.head<2>().norm(), 1.5e-4);
  EXPECT_NEAR(up.z(), 0.03, 1e-4);
}

TEST(CalibrateLasers, FindsThePlanesByThePlatformAlone) {
  const Turn empty(LitScene{});
  Scan told = empty.truth();
  told.laser->lasers[0] = turned(empty.truth().laser->lasers[0], 0.05);

  const LaserCalibration found = empty.solve(told);

  ASSERT_TRUE(found.report.accepted) << found.report.reason;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LT(degrees_between(found.lasers[i], empty.truth().laser->lasers[i]), 0.01);
  }
}

TEST(CalibrateLasers, IsRefusedWhereThePlatformIsNotSeen) {
  const Turn floating(LitScene{.balls = two_balls.balls, .platform_radius = 0});

  const LaserCalibration found = floating.solve(floating.truth());

  EXPECT_FALSE(found.report.accepted);
  EXPECT_FALSE(found.report.reason.empty());
}

// The pictures of every second of the 104 stops do not exist, so reading one would fail.
TEST(CalibrateLasers, ReadsAtMostAHundredStops) {
  const TemporaryFolder folder;
  const Scan half = write_laser_scan(folder.path(), two_balls, 52);
  Scan whole = half;
  whole.shots.clear();
  for (const Shot& shot : half.shots) {
    whole.shots.push_back(shot);
    whole.shots.push_back({.pictures = {"none.png", "none.png", "none.png"}, .angle = shot.angle});
  }

  const LaserCalibration found = calibrate_lasers(folder.path(), whole, 1);

  ASSERT_TRUE(found.report.accepted) << found.report.reason;
  EXPECT_EQ(found.lasers[0].normal, calibrate_lasers(folder.path(), half, 1).lasers[0].normal);
}

TEST(CalibrateLasers, NamesAPlatformThatTurnedTheOtherWay) {
  Scan told = Turn::of_two_balls().truth();
  for (Shot& shot : told.shots) {
    shot.angle = -shot.angle;
  }

  const LaserCalibration found = Turn::of_two_balls().solve(told);

  EXPECT_FALSE(found.report.accepted);
  ASSERT_EQ(found.report.findings.size(), 1U);
  EXPECT_EQ(found.report.findings[0].code, "turn-ratio");
  EXPECT_NE(found.report.reason.find("90 degrees clockwise"), std::string::npos)
      << found.report.reason;
}

TEST(CalibrateLasers, NamesNoOtherWayOfAPlatformThatTurnedAsItShould) {
  EXPECT_TRUE(Turn::of_two_balls().solve(Turn::of_two_balls().truth()).report.findings.empty());
}

TEST(CalibrateLasers, NamesLasersThatAreExchanged) {
  Scan told = Turn::of_two_balls().truth();
  std::vector<Laser>& lasers = told.laser->lasers;
  std::swap(lasers[0].normal, lasers[1].normal);
  std::swap(lasers[0].distance, lasers[1].distance);
  std::swap(lasers[0].source, lasers[1].source);
  lasers[0] = turned(lasers[0], 0.1);

  const LaserCalibration found = Turn::of_two_balls().solve(told);

  EXPECT_FALSE(found.report.accepted);
  ASSERT_EQ(found.report.findings.size(), 1U) << found.report.reason;
  EXPECT_EQ(found.report.findings[0].code, "lasers-exchanged") << found.report.reason;
  EXPECT_EQ(found.report.reason, found.report.findings[0].detail);
}

TEST(CalibrateLasers, NamesAStopToWhichThePlatformSlipped) {
  for (const std::size_t at : {1U, 17U}) {
    Scan told = Turn::of_two_balls().truth();
    for (std::size_t stop = at; stop < told.shots.size(); ++stop) {
      told.shots[stop].angle -= radians_from_degrees(1.4);
    }

    const LaserCalibration found = Turn::of_two_balls().solve(told);

    ASSERT_TRUE(found.report.accepted) << found.report.reason;
    ASSERT_EQ(found.report.findings.size(), 1U);
    EXPECT_EQ(found.report.findings[0].code, "slip");
    EXPECT_EQ(found.report.findings[0].stop, static_cast<int>(at));
    ASSERT_EQ(found.report.slipped.size(), told.shots.size());
    EXPECT_EQ(found.report.slipped[at - 1], 0);
    EXPECT_NEAR(degrees_from_radians(found.report.slipped[at]), 1.4, 0.25);
    EXPECT_FALSE(found.report.confirms_told());
  }
}

TEST(CalibrateLasers, IsTheSameForAnyThreads) {
  const Scan& truth = Turn::of_two_balls().truth();
  Scan told = truth;
  told.laser->lasers[0] = turned(truth.laser->lasers[0], 0.08);

  const LaserCalibration alone = Turn::of_two_balls().solve(told, 1);
  const LaserCalibration several = Turn::of_two_balls().solve(told, 3);

  EXPECT_EQ(alone.report.platform_from_sensor.matrix(),
            several.report.platform_from_sensor.matrix());
  EXPECT_EQ(alone.lasers[0].normal, several.lasers[0].normal);
}

}  // namespace
}  // namespace octurn
