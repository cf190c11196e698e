// How much a sensor's fixed error pattern harms a model, and how much of that a sensor map repairs.

#include "octurn/sensor_map.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "core/tsdf/simulated_scan.hpp"
#include "core/tsdf/surface_errors.hpp"

namespace octurn {
namespace {

constexpr SimulatedTurn turn{.snapshots = 8, .frames = 5};

/// A wall seen by the simulated Kinect with a real one's error pattern.
WallView wall_at(double distance) {
  SimulatedKinect kinect(Scene::of_wall(distance), 1, 1, 1);
  WallView view{Intrinsics{}};
  for (std::uint32_t frame = 1; frame <= 20; ++frame) {
    DepthFrame seen{.width = 640, .height = 480, .depth = {}};
    seen.depth.resize(std::size_t{640} * 480);
    kinect.expose(0, frame, seen.depth);
    view.add(seen);
  }
  return view;
}

double mean_error(const std::vector<Snapshot>& snapshots) {
  return errors_of(solid_of(scan_options(), snapshots).facets, robot().distance).mean;
}

double mean_error_with(const std::vector<WallView>& walls, std::vector<Snapshot> snapshots) {
  const SensorMapReport report = fit_sensor_map(walls);
  EXPECT_TRUE(report.accepted) << report.reason;
  for (Snapshot& snapshot : snapshots) {
    snapshot.frame =
        corrected(std::move(snapshot.frame), report.map, snapshot.intrinsics.depth_unit);
  }
  return mean_error(snapshots);
}

// The bounds are required accuracies: 1.35 times the error without a pattern after one wall at the
// object's distance, 1.2 times after two.
TEST(SensorMap, GivesAModelBackWhatTheSensorsPatternCost) {
  const double without = mean_error(simulated_scan(robot(), turn));
  SimulatedTurn with_pattern = turn;
  with_pattern.pattern = 1;
  const std::vector<Snapshot> snapshots = simulated_scan(robot(), with_pattern);
  const double as_it_is = mean_error(snapshots);
  const double after_one = mean_error_with({wall_at(0.66)}, snapshots);
  const double after_two = mean_error_with({wall_at(0.58), wall_at(0.85)}, snapshots);

  EXPECT_GT(as_it_is, 1.4 * without);  // the pattern is strong enough to matter
  EXPECT_LT(after_one, 1.35 * without);
  EXPECT_LT(after_two, 1.2 * without);
  RecordProperty("mean_mm", std::to_string(without) + " " + std::to_string(as_it_is) + " " +
                                std::to_string(after_one) + " " + std::to_string(after_two));
}

}  // namespace
}  // namespace octurn
