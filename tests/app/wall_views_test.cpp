#include "capture/wall_views.hpp"

#include <gtest/gtest.h>

#include <optional>

#include "calibration/optics_files.hpp"
#include "calibration/sensor_map_files.hpp"
#include "octurn/png.hpp"
#include "simulator/simulated_kinect.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

/// A simulated Kinect's view of a wall. @param distance  metres
WallView look_at(double distance, std::optional<double> on_for = {}) {
  SimulatedKinect kinect(Scene::of_wall(distance), 1, 1, 1);
  DepthFrame frame{.width = 640, .height = 480, .depth = std::vector<std::uint16_t>(640U * 480U)};
  WallView view(Intrinsics{}, on_for);
  for (std::uint32_t number = 1; number <= 6; ++number) {
    kinect.expose(0, number, frame.depth);
    view.add(frame);
  }
  return view;
}

class WallViews : public ::testing::Test {
 protected:
  SensorMapReport add(double distance) { return add_wall(data_.path(), "A1", look_at(distance)); }
  SensorMap map() const { return read_sensor_map(sensor_map_path(data_.path(), "A1")); }

  TemporaryFolder data_;
};

TEST_F(WallViews, MakeAMapThatIsKept) {
  const SensorMapReport report = add(0.65);
  ASSERT_TRUE(report.accepted) << report.reason;
  EXPECT_EQ(report.map.serial, "A1");
  EXPECT_TRUE(report.map.near.empty());
  EXPECT_EQ(map().serial, "A1");
  EXPECT_EQ(map().made, report.map.made);
  EXPECT_LT(map().after, 0.6 * map().before);  // removes the pattern, not the speckle
  EXPECT_TRUE(map().far.empty());
}

// The map equals one from the views themselves: means are stored with an error of up to 0.05 mm,
// 0.04 steps of disparity.
TEST_F(WallViews, AreKeptAsTheirMean) {
  add(0.65);
  const std::vector<WallView> views{look_at(0.9), look_at(0.65)};
  const SensorMapReport expected = fit_sensor_map(views);
  const SensorMapReport report = add(0.9);
  ASSERT_TRUE(report.accepted) << report.reason;
  ASSERT_EQ(report.walls.size(), 2U);
  const SensorMap found = map();
  ASSERT_EQ(found.far.size(), expected.map.far.size());
  for (std::size_t i = 0; i < found.far.size(); i += 97) {
    ASSERT_NEAR(found.near[i], expected.map.near[i], 0.04 * disparity_unit);
    ASSERT_NEAR(found.far[i], expected.map.far[i], 0.04 * disparity_unit);
  }
}

TEST_F(WallViews, GiveWayToOneAtTheirDistance) {
  EXPECT_EQ(next_wall(data_.path(), "A1"), 0.65);
  add(0.65);
  EXPECT_EQ(next_wall(data_.path(), "A1"), 0.9);
  EXPECT_EQ(next_wall(data_.path(), "A2"), 0.65);
  add(0.9);
  const SensorMapReport again = add(0.7);
  ASSERT_EQ(again.walls.size(), 2U);
  EXPECT_NEAR(again.walls[0].distance, 0.7, 0.005);
  EXPECT_NEAR(again.walls[1].distance, 0.9, 0.005);
}

// The first view is read back from its file.
TEST_F(WallViews, TellForHowLongTheSensorWasOn) {
  add_wall(data_.path(), "A1", look_at(0.65, 620));
  EXPECT_EQ(map().on_for, 620);
  add_wall(data_.path(), "A1", look_at(0.9, 700));
  EXPECT_EQ(map().on_for, 620) << "the shorter of both";
  EXPECT_EQ(find_map_summary(data_.path(), "A1")->on_for, 620);
  add_wall(data_.path(), "A1", look_at(0.65));
  EXPECT_EQ(map().on_for, 700);
}

TEST_F(WallViews, ChangeNothingWhereTheWallIsRefused) {
  add(0.65);
  const std::string before = content_of(sensor_map_path(data_.path(), "A1"));
  const SensorMapReport report = add(2.5);
  EXPECT_FALSE(report.accepted);
  EXPECT_NE(report.reason.find("2.5 m away"), std::string::npos) << report.reason;
  EXPECT_TRUE(content_of(sensor_map_path(data_.path(), "A1")) == before);
  EXPECT_EQ(next_wall(data_.path(), "A1"), 0.9);
}

TEST_F(WallViews, MakeTheMapAgainForOtherOptics) {
  add(0.65);
  add(0.9);
  const SensorMap before = map();
  EXPECT_FALSE(before.optics);
  const OpticsRecord record{.optics = {.value = {.fx = 590, .fy = 590, .k1 = -0.1}, .sigma = {}},
                            .at = "2026-11-28T08:00:00Z"};
  keep_optics(data_.path(), "A1", record);
  remake_sensor_map(data_.path(), "A1");
  EXPECT_EQ(map().optics, record.optics.value);
  EXPECT_NE(map().near, before.near);
  undo_optics(data_.path(), "A1");
  remake_sensor_map(data_.path(), "A1");
  EXPECT_FALSE(map().optics);
  EXPECT_EQ(map().near, before.near);
  EXPECT_EQ(map().far, before.far);
}

TEST_F(WallViews, LeaveAMapThatHasNone) {
  put(sensor_map_path(data_.path(), "A1"), "brought from another machine");
  remake_sensor_map(data_.path(), "A1");
  EXPECT_EQ(content_of(sensor_map_path(data_.path(), "A1")), "brought from another machine");
}

TEST_F(WallViews, LeaveTheMapWhereOneCannotBeRead) {
  add(0.65);
  const std::string before = content_of(sensor_map_path(data_.path(), "A1"));
  for (const auto& file :
       std::filesystem::recursive_directory_iterator(wall_views_path(data_.path(), "A1"))) {
    if (file.path().extension() == ".png") {
      put(file.path(), "damaged");
    }
  }
  remake_sensor_map(data_.path(), "A1");
  EXPECT_TRUE(content_of(sensor_map_path(data_.path(), "A1")) == before);
}

TEST_F(WallViews, GoWithTheirMap) {
  add(0.65);
  put(sensor_map_path(data_.path(), "A2"), "another sensor's");
  ASSERT_TRUE(find_map_summary(data_.path(), "A1"));
  remove_sensor_map(data_.path(), "A1");
  EXPECT_FALSE(find_map_summary(data_.path(), "A1"));
  EXPECT_EQ(next_wall(data_.path(), "A1"), 0.65);
  EXPECT_EQ(content_of(sensor_map_path(data_.path(), "A2")), "another sensor's");
}

TEST(SensorMapSummary, HasTheMeansOfBlocks) {
  SensorMap map{.width = 16, .height = 8, .near = std::vector<float>(128, 1.0F)};
  for (std::size_t row = 0; row < 8; ++row) {
    for (std::size_t column = 8; column < 16; ++column) {
      map.near[row * 16 + column] = static_cast<float>(row);
    }
  }
  const SensorMapSummary summary = summarise(map);
  EXPECT_EQ(summary.columns, 2);
  EXPECT_EQ(summary.rows, 1);
  EXPECT_EQ(summary.errors, (std::vector<float>{1.0F, 3.5F}));
}

}  // namespace
}  // namespace octurn
