#include <gtest/gtest.h>

#include <cmath>

#include "app/simulated_frames.hpp"
#include "doctor/turn_checks.hpp"
#include "octurn/snapshot.hpp"
#include "sensor/simulated_mechanism.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

const Box clip{.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}};

// The sensor's noise makes an error of 0.1 degrees between two looks, and of 0.3 degrees in a whole
// turn.
constexpr double turn_error_deg = 1;
constexpr double look_error_deg = 0.5;

TurnMeasurement measured(const SimulatedMechanism& mechanism,
                         const Eigen::Isometry3d& pose = nominal_platform_from_sensor(),
                         const std::string& uri = simulation_uri({.pattern = 1, .speed = 20})) {
  Rig rig({.sensor_uri = uri, .speed = 20, .open_sensor = [&](const std::string& opened) {
             return on_mechanism(open_sensor(opened), mechanism);
           }});
  return measure_turn(rig, pose, clip, {}, [](double) {});
}

TEST(MeasureTurn, SeesAWholeTurnWithoutPlay) {
  const TurnMeasurement turn = measured({});
  EXPECT_NEAR(turn.turn_deg, 360, turn_error_deg);
  EXPECT_NEAR(turn.play_deg, 0, look_error_deg);
  EXPECT_NEAR(turn.return_deg, 0, look_error_deg);
}

TEST(MeasureTurn, SeesAnotherGearAndAnotherDirection) {
  EXPECT_NEAR(measured({.rate = 0.75}).turn_deg, 270, turn_error_deg);
  EXPECT_NEAR(measured({.rate = 2}).turn_deg, 720, 2 * turn_error_deg);
  EXPECT_NEAR(measured({.rate = -0.25}).turn_deg, -90, turn_error_deg);
}

TEST(MeasureTurn, SeesAGearThatIsManyTimesOff) {
  EXPECT_NEAR(measured({.rate = 6}).turn_deg, 6 * 360, 2 * 6 * turn_error_deg);
  EXPECT_NEAR(measured({.rate = 1.0 / 12}).turn_deg, 30, turn_error_deg);
}

TEST(MeasureTurn, SeesPlayThatIsNotTakenUp) {
  const double play = radians_from_degrees(2);
  EXPECT_NEAR(measured({.play = play}).play_deg, 2, look_error_deg);
  EXPECT_NEAR(measured({.rate = -1, .play = play}).play_deg, 2, look_error_deg);
}

TEST(MeasureTurn, NeedsAPoseThatIsRoughlyRight) {
  const std::string askew = simulation_uri({.pattern = 1, .misalignment = 1, .speed = 20});
  EXPECT_NEAR(measured({}, nominal_platform_from_sensor(), askew).turn_deg, 360, turn_error_deg);
  Eigen::Isometry3d off = nominal_platform_from_sensor();
  off.prerotate(Eigen::AngleAxisd(radians_from_degrees(1), Eigen::Vector3d::UnitX()));
  off.pretranslate(Eigen::Vector3d(0.008, -0.004, 0));
  EXPECT_NEAR(measured({.rate = 0.75}, off).turn_deg, 270, 2 * turn_error_deg);
}

TEST(MeasureTurn, SeesAPlatformThatStandsStill) { EXPECT_EQ(measured({.rate = 1e-9}).turn_deg, 0); }

TEST(MeasureTurn, RefusesAPlatformWithoutAnObject) {
  const BoxesOnPlatform far(
      {Eigen::AlignedBox3d(Eigen::Vector3d(300, 300, 0), Eigen::Vector3d(310, 310, 10))});
  EXPECT_EQ(code_thrown_by([&] { measured({}, nominal_platform_from_sensor(), far.uri(1, 20)); }),
            "sensor-blind");
}

TEST(MeasureTurn, EndsWhereItIsStopped) {
  Rig rig({.sensor_uri = simulation_uri({.speed = 20}), .speed = 20});
  std::stop_source stop;
  const auto stop_it = [&](double) { stop.request_stop(); };
  EXPECT_THROW(measure_turn(rig, nominal_platform_from_sensor(), clip, stop.get_token(), stop_it),
               Stopped);
}

}  // namespace
}  // namespace octurn
