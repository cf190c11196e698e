// The solid method on bad scans: the model is always one closed part whose observed surface is near
// the true one. The tests print the measured errors.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "core/mesh/surface.hpp"
#include "core/tsdf/simulated_scan.hpp"
#include "core/tsdf/surface_errors.hpp"
#include "mesh/mesh_check.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

// Error of a reading, millimetres: root mean square over the platform at 0.65 m of the mean of ten
// frames, as kinect_noise_test measures it (simulated_kinect.hpp). Conditioning and averaging over
// snapshots reduce it further.
constexpr double reading_sigma_mm = 0.57;

/// Fails unless the model is one closed part whose observed surface errs no more than single
/// readings with normal noise: sqrt(2 / pi) sigma on average, 1.96 sigma in 95 of 100 places.
/// @param noise  as a multiple of a real Kinect's
void expect_sound(const std::string& what, const std::vector<Snapshot>& snapshots,
                  const SimulatedObject& object, double noise = 1) {
  const double sigma = noise * reading_sigma_mm;
  const Errors max{.mean = std::sqrt(2 / std::numbers::pi) * sigma, .p95 = 1.96 * sigma};
  const SolidModel model = solid_of(scan_options(), snapshots);
  ASSERT_FALSE(model.facets.empty());
  EXPECT_EQ(model.count.parts, 1U);
  EXPECT_TRUE(topology_of(model.facets).manifold);
  MeshCheck check;
  check.add(model.facets);
  const Errors errors = errors_of(model.facets, object.distance);
  EXPECT_LT(errors.mean, max.mean);
  EXPECT_LT(errors.p95, max.p95);
  std::printf("| %s | %.2f | %.2f | %.0f %% | %.1f |\n", what.c_str(), errors.mean, errors.p95,
              100 * check.filled_share(), check.volume_mm3() / 1000);
}

SimulatedObject hollow() {
  const Eigen::Vector3d size(0.12, 0.1, 0.05);
  return standing(hollowed_block(size, 0.035), size);
}

TEST(Robustness, OfAnOrdinaryScan) {
  expect_sound("robot", simulated_scan(robot()), robot());
  expect_sound("hollowed block", simulated_scan(hollow()), hollow());
}

TEST(Robustness, ToTwiceTheNoise) {
  const SimulatedTurn noisy{.noise = 2};
  expect_sound("robot, noise doubled", simulated_scan(robot(), noisy), robot(), 2);
  expect_sound("hollowed block, noise doubled", simulated_scan(hollow(), noisy), hollow(), 2);
}

TEST(Robustness, ToMissingSnapshots) {
  const std::vector<Snapshot> all = simulated_scan(robot());
  expect_sound("robot, every other snapshot missing", {all[0], all[2], all[4], all[6]}, robot());
  expect_sound("robot, half the turn missing", {all[0], all[1], all[2], all[3]}, robot());
}

TEST(Robustness, ToHolesInTheDepth) {
  std::vector<Snapshot> snapshots = simulated_scan(robot());
  std::mt19937 random(1);
  const auto number = [&](int end) {
    return static_cast<int>(random() % static_cast<unsigned>(end));
  };
  for (Snapshot& snapshot : snapshots) {
    for (int hole = 0; hole < 200; ++hole) {  // 3 to 22 pixels wide: a third of the image in all
      const int left = number(620);
      const int top = number(460);
      const int width = 3 + number(20);
      const int height = 3 + number(20);
      for (int v = top; v < std::min(top + height, 480); ++v) {
        for (int u = left; u < std::min(left + width, 640); ++u) {
          snapshot.frame.depth[static_cast<std::size_t>(v * 640 + u)] = 0;
        }
      }
    }
  }
  expect_sound("robot, holes in the depth", snapshots, robot());
}

TEST(Robustness, ToAnObjectOffCentre) {
  const SimulatedObject object = standing_block({0.05, 0.04, 0.06}, {0.09, 0.06, 0});
  expect_sound("block, 11 cm off the axis", simulated_scan(object), object);
}

TEST(Robustness, ToAnObjectTallerThanTheView) {
  const SimulatedObject object = standing_block({0.05, 0.04, 0.42});
  expect_sound("column of 42 cm", simulated_scan(object), object);
}

TEST(Robustness, ToAnEmptyPlatform) {
  // An object too low to be reconstructed leaves only the platform, its edge and the table.
  const SimulatedObject object = standing_block({0.004, 0.004, 0.0005});
  EXPECT_TRUE(solid_of(scan_options(), simulated_scan(object)).facets.empty());
  EXPECT_TRUE(solid_of(scan_options(), simulated_scan(object, {.noise = 2})).facets.empty());
}

}  // namespace
}  // namespace octurn
