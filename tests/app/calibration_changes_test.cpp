// Concurrent changes of the sensor's pose.

#include <gtest/gtest.h>

#include <barrier>
#include <thread>

#include "calibration/calibration_store.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

TEST(CalibrationStore, KeepsBothOfTwoChangesAtOnce) {
  constexpr int rounds = 20;  // a store that reads too early loses a change in most rounds
  for (int round = 0; round < rounds; ++round) {
    const TemporaryFolder folder;
    CalibrationStore store(folder.path());
    Eigen::Isometry3d turned = nominal_platform_from_sensor();
    turned.rotate(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitX()));
    std::barrier begin(2);
    std::thread scaling([&] {
      begin.arrive_and_wait();
      store.change({.scale = 1.01}, {});
    });
    begin.arrive_and_wait();
    store.change({.platform_from_sensor = turned}, {});
    scaling.join();

    const ScanSettings now = store.in_force({});
    EXPECT_EQ(now.depth_scale, 1.01);
    EXPECT_EQ(now.platform_from_sensor.linear(), turned.linear());
  }
}

}  // namespace
}  // namespace octurn
