#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "core/calibrate/rendered_turn.hpp"
#include "octurn/optics_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// All numbers of a report as JSON, which prints each double with enough digits to restore its
/// bits.
std::string to_text(const CalibrationReport& report) {
  json rows = json::array();
  for (int row = 0; row < 4; ++row) {
    json cells = json::array();
    for (int column = 0; column < 4; ++column) {
      cells.push_back(report.platform_from_sensor.matrix()(row, column));
    }
    rows.push_back(cells);
  }
  return json{{"platform_from_sensor", rows},
              {"position_sigma", report.position_sigma},
              {"direction_sigma", report.direction_sigma},
              {"before", report.before},
              {"after", report.after},
              {"stop_offsets", report.stop_offsets}}
             .dump(1) +
         "\n";
}

std::string golden_text(const char* name) {
  std::ifstream file(std::filesystem::path(OCTURN_GOLDEN) / name);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// CI also runs this test on arm64.
TEST(Calibrate, GivesTheSameBitsOnEveryProcessorAndForAnyNumberOfThreads) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.platform_from_sensor = wrong_pose({0.01, -0.005, 0.004}, {1, 0.4, 0}, 2);
  for (const int threads : {1, 4}) {
    const CalibrationReport report = calibrate(turn, threads);
    ASSERT_TRUE(report.accepted) << report.reason;
    EXPECT_EQ(to_text(report), golden_text("solved_pose.json")) << threads << " threads";
  }
}

TEST(Calibrate, GivesTheSameBitsOfOpticsOnEveryProcessorAndForAnyNumberOfThreads) {
  CalibrationTurn turn = rendered_turn(figure(), 8);
  turn.intrinsics = {.fx = 590.5, .fy = 590.5, .cx = 311, .cy = 246.5};
  for (const int threads : {1, 2, 4}) {
    const CalibrationReport report = calibrate(turn, threads);
    ASSERT_TRUE(report.optics_differ) << report.reason;
    EXPECT_EQ(to_text(report) + to_json(*report.optics).dump(1) + "\n",
              golden_text("solved_optics.txt"))
        << threads << " threads";
  }
}

}  // namespace
}  // namespace octurn
