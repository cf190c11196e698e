#include "settings/laser_settings.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "config.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

Config config_of(const json& content, const std::optional<SensorKind>& sensor = {}) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "octurn.json") << content;
  return read_config(folder.path() / "octurn.json", sensor);
}

std::string refusal_of(const json& content) {
  return error_thrown_by([&] { config_of(content); }).what();
}

TEST(LaserSettings, HavePlanesThroughThePlatformsAxisAndTheLasers) {
  const LaserSettings settings;
  const std::vector<Laser> lasers = laser_camera(settings).lasers;
  ASSERT_EQ(lasers.size(), 2U);
  for (const Laser& laser : lasers) {
    const auto off = [&](const Eigen::Vector3d& point) {
      return laser.normal.dot(point) - laser.distance;
    };
    const Eigen::Isometry3d sensor_from_platform = settings.platform_from_sensor.inverse();
    EXPECT_NEAR(laser.normal.norm(), 1, 1e-12);
    EXPECT_NEAR(off(sensor_from_platform * Eigen::Vector3d::Zero()), 0, 1e-12);
    EXPECT_NEAR(off(sensor_from_platform * Eigen::Vector3d(0, 0, 0.1)), 0, 1e-12);
    EXPECT_NEAR(off(*laser.source), 0, 1e-12);
    const Eigen::Vector3d source = settings.platform_from_sensor * *laser.source;
    EXPECT_EQ(source.x() < 0, laser.name == "left");
    EXPECT_NEAR(source.z(), 0.25, 1e-12);
  }
}

TEST(LaserSettings, AreReadWithTheirLinesAndPlanes) {
  const Config config = config_of(
      {{"sensor", "laser-line"},
       {"laser",
        {{"width", 1640},
         {"k1", -0.05},
         {"left", {{"line", ""}}},
         {"right",
          {{"line", "GPIO12"}, {"plane_m", {0.6, 0, 0.8, 0.1}}, {"source_m", {0.1, 0, 0.05}}}}}}});
  EXPECT_EQ(config.sensor, SensorKind::laser_line);
  EXPECT_EQ(config.laser.lens.width, 1640);
  EXPECT_EQ(to_gpio_names(config.laser), std::vector<std::string>{"GPIO12"});
  const LaserCamera camera = laser_camera(config.laser);
  ASSERT_EQ(camera.lasers.size(), 1U);
  EXPECT_EQ(camera.k1, -0.05);
  EXPECT_EQ(camera.lasers[0].name, "right");
  EXPECT_TRUE(camera.lasers[0].normal.isApprox(Eigen::Vector3d(0.6, 0, 0.8)));
  EXPECT_NEAR(camera.lasers[0].distance, 0.1, 1e-12);
}

TEST(LaserSettings, DecideWhatAScanHasByDefault) {
  EXPECT_EQ(config_of(json::object()).scan.snapshots, 36);
  const Config config = config_of({{"scan", {{"snapshots", 50}}}}, SensorKind::laser_line);
  EXPECT_EQ(config.scan.snapshots, 50);
  EXPECT_EQ(config.scan.leaf_size, 0.0005);
  EXPECT_EQ(config_of({{"sensor", "laser-line"}}, SensorKind::depth).scan.leaf_size, 0.001);
}

TEST(LaserSettings, RefuseALineThatIsHighWhileThePiBoots) {
  const std::string refusal = refusal_of({{"laser", {{"right", {{"line", "GPIO5"}}}}}});
  EXPECT_NE(refusal.find("laser.right"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("GPIO5"), std::string::npos) << refusal;
}

TEST(LaserSettings, RefuseLinesThatTwoSignalsShare) {
  const std::string twice = refusal_of({{"laser", {{"right", {{"line", "GPIO23"}}}}}});
  EXPECT_NE(twice.find("laser.right"), std::string::npos) << twice;
  const std::string motor =
      refusal_of({{"sensor", "laser-line"}, {"laser", {{"left", {{"line", "GPIO17"}}}}}});
  EXPECT_NE(motor.find("GPIO17"), std::string::npos) << motor;
}

TEST(LaserSettings, RefuseARigWithoutALaser) {
  const json none{{"line", ""}};
  EXPECT_NE(refusal_of({{"laser", {{"left", none}, {"right", none}}}}).find("laser.left"),
            std::string::npos);
}

TEST(LaserSettings, RefuseWhatIsNoPlaneOrHasItsLaserElsewhere) {
  for (const json& plane : {json{1, 1, 0, 0}, json{1, 0, 0}, json("x"), json{1, 0, 0, 11}}) {
    EXPECT_NE(refusal_of({{"laser", {{"left", {{"plane_m", plane}}}}}}).find("plane_m"),
              std::string::npos)
        << plane;
  }
  EXPECT_NE(
      refusal_of({{"laser", {{"left", {{"plane_m", {1, 0, 0, 0}}, {"source_m", {1, 0, 0}}}}}}})
          .find("source_m"),
      std::string::npos);
}

}  // namespace
}  // namespace octurn
