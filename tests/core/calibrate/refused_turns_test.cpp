#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/calibrate/rendered_turn.hpp"
#include "octurn/calibrate.hpp"

namespace octurn {
namespace {

std::string reason(const CalibrationTurn& turn) {
  const CalibrationReport report = calibrate(turn);
  EXPECT_FALSE(report.accepted);
  return report.reason;
}

TEST(Calibrate, RefusesAnEmptyPlatform) {
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  EXPECT_NE(reason(rendered_turn(nothing, 8)).find("too little of an object"), std::string::npos);
}

TEST(Calibrate, RefusesAnObjectOfFiveMillimetres) {
  EXPECT_NE(reason(rendered_turn(ball({0, 0, 0.0025}, 0.0025), 8)).find("too little of an object"),
            std::string::npos);
}

TEST(Calibrate, RefusesTwoStops) {
  EXPECT_NE(reason(rendered_turn(figure(), 2)).find("too few stops"), std::string::npos);
}

TEST(Calibrate, RefusesAPictureWithoutAPlatform) {
  CalibrationTurn turn = rendered_turn(figure(), 2);
  turn.angles = {0, 0.7, 1.4, 2.1};
  turn.read = [](std::size_t) {
    return DepthFrame{.width = 640, .height = 480, .depth = std::vector<std::uint16_t>(640 * 480)};
  };
  EXPECT_NE(reason(turn).find("platform was not found"), std::string::npos);
}

TEST(Calibrate, RefusesAnImageOfAnotherSize) {
  CalibrationTurn turn = rendered_turn(figure(), 4);
  turn.intrinsics.width = 641;
  EXPECT_THROW(calibrate(turn), std::invalid_argument);
}

}  // namespace
}  // namespace octurn
