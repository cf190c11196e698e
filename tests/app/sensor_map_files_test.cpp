#include "calibration/sensor_map_files.hpp"

#include <gtest/gtest.h>

#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

TEST(SensorMapFiles, AreNamedAfterTheSerialNumber) {
  EXPECT_EQ(sensor_map_path("/data", "A00361"), fs::path("/data/sensor-maps/A00361.png"));
  EXPECT_EQ(sensor_map_path("/data", "1d27/0601@1/7"),
            fs::path("/data/sensor-maps/1d27_0601_1_7.png"));
  EXPECT_EQ(sensor_map_path("/data", "../../etc"), fs::path("/data/sensor-maps/.._.._etc.png"));
}

TEST(SensorMapFiles, GoIntoTheFolderOfAScan) {
  const TemporaryFolder data;
  const fs::path scan = data.path() / "scan";
  fs::create_directory(scan);
  put(sensor_map_path(data.path(), "A1"), "a map");

  keep_sensor_map(data.path(), "A1", scan);

  EXPECT_EQ(content_of(scan / "sensor-map.png"), "a map");
}

TEST(SensorMapFiles, AreNotThoseOfAnotherSensor) {
  const TemporaryFolder data;
  const fs::path scan = data.path() / "scan";
  fs::create_directory(scan);
  put(sensor_map_path(data.path(), "A1"), "a map");
  put(sensor_map_path(data.path(), ""), "nobody's map");

  keep_sensor_map(data.path(), "A2", scan);
  keep_sensor_map(data.path(), "", scan);

  EXPECT_TRUE(fs::is_empty(scan));
}

}  // namespace
}  // namespace octurn
