#include "capture/platform_swing.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "app/simulated_frames.hpp"

namespace octurn {
namespace {

const PlatformLook nominal_look{.intrinsics = {},
                                .platform_from_sensor = nominal_platform_from_sensor(),
                                .clip = {.min = {-0.14, -0.14, 0.005}, .max = {0.14, 0.14, 0.4}}};

/// Frames of the simulator's own object, with a Kinect's noise, at angles in degrees.
std::vector<DepthFrame> frames_at(const std::vector<double>& angles_deg,
                                  const std::string& uri = simulation_uri({.speed = 20})) {
  const auto sensor = open_sensor(uri);
  std::vector<DepthFrame> frames;
  for (const double angle_deg : angles_deg) {
    frames.push_back(frame_at(*sensor, radians_from_degrees(angle_deg)).frame);
  }
  return frames;
}

TEST(PlatformSwing, IsNotSeenWhereThereIsNoiseOnly) {
  for (const double angle_deg : {0.0, 40.0, 130.0, 250.0}) {
    EXPECT_FALSE(is_swinging(nominal_look, frames_at(std::vector<double>(10, angle_deg))))
        << angle_deg;
  }
  const std::string noisy = simulation_uri({.noise = 3, .speed = 20});
  EXPECT_FALSE(is_swinging(nominal_look, frames_at(std::vector<double>(10, 0), noisy)));
}

TEST(PlatformSwing, IsSeenFromADegree) {
  for (const double angle_deg : {0.0, 40.0, 130.0, 250.0}) {
    for (const double swing_deg : {1.0, -1.0, 1.5}) {
      EXPECT_TRUE(is_swinging(nominal_look, frames_at({angle_deg, angle_deg + swing_deg})))
          << angle_deg << ", " << swing_deg;
    }
  }
}

TEST(PlatformSwing, IsSeenAlsoWhereItEndsWhereItBegan) {
  EXPECT_TRUE(is_swinging(nominal_look, frames_at({0, 1, 0})));
}

TEST(PlatformSwing, MakesTheNextStopsWaitAndLessAndLessOnceItIsOver) {
  Settling settling;
  EXPECT_EQ(settling.frames(), 0);
  settling.stood_after(20);
  EXPECT_EQ(settling.frames(), 20);
  settling.stood_after(30);
  EXPECT_EQ(settling.frames(), 30);
  settling.stood_after(0);
  EXPECT_EQ(settling.frames(), 29);
  settling.stood_after(1000);
  EXPECT_EQ(settling.frames(), max_settling_frames);
}

}  // namespace
}  // namespace octurn
