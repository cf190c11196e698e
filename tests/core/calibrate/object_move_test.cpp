#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "core/calibrate/rendered_turn.hpp"
#include "core/io/scan_json.hpp"
#include "octurn/calibrate.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using nlohmann::json;

const Box clip{.min = {-0.14, -0.14, 0.002}, .max = {0.14, 0.14, 0.4}};
constexpr double error_mm = 0.3;  // three sigma of the readings' noise, for a 12 cm figure
constexpr double error_deg = 0.4;

Snapshot first_look(const Shape& object,
                    const Eigen::Isometry3d& told = true_platform_from_sensor()) {
  std::mt19937 random(1);
  return {.frame = rendered_frame(object, 0, random), .intrinsics = {}, .object_from_sensor = told};
}

DepthFrame last_look(const Shape& object, double angle = 0) {
  std::mt19937 random(2);
  return rendered_frame(object, angle, random);
}

/// The same frame seen by a sensor with a fixed, smooth error pattern of 0.8 units of disparity.
DepthFrame with_pattern(DepthFrame frame) {
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const double error = 0.8 * (std::sin(static_cast<double>(i % 640) / 21) +
                                std::sin(static_cast<double>(i / 640) / 17));
    const double depth = frame.depth[i] * 0.0001;
    frame.depth[i] =
        frame.depth[i] == 0
            ? std::uint16_t{0}
            : static_cast<std::uint16_t>(std::lround(1e4 / (1 / depth + error / 345.489)));
  }
  return frame;
}

std::vector<CalibrationFinding> found(const ObjectMove& move) {
  std::vector<CalibrationFinding> findings;
  add_move(findings, move);
  return findings;
}

TEST(ObjectMove, IsNoneOfAnObjectAtRest) {
  const auto move = measure_move(first_look(figure()), last_look(figure()), clip);
  ASSERT_TRUE(move);
  EXPECT_LT(mm_from_metres(move->shift), error_mm);
  EXPECT_LT(std::abs(degrees_from_radians(move->turn)), error_deg);
  EXPECT_TRUE(found(*move).empty());
}

TEST(ObjectMove, IsMeasuredInMillimetresAndTold) {
  const auto move =
      measure_move(first_look(figure()), last_look(moved(figure(), {0.0015, -0.0015, 0})), clip);
  ASSERT_TRUE(move);
  EXPECT_NEAR(mm_from_metres(move->shift), 2.12, error_mm);
  EXPECT_LT(std::abs(degrees_from_radians(move->turn)), error_deg);
  const auto findings = found(*move);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].code, "moved");
  const std::string& detail = findings[0].detail;
  EXPECT_NEAR(std::stod(detail.substr(detail.find("moved by ") + 9)), 2.1, error_mm) << detail;
  ASSERT_EQ(findings[0].parameters.size(), 1U);
  EXPECT_NEAR(std::get<double>(findings[0].parameters.at("shift_mm")), 2.12, error_mm);
}

TEST(ObjectMove, TellsATurnFromAShift) {
  const auto move =
      measure_move(first_look(figure()), last_look(figure(), radians_from_degrees(1.8)), clip);
  ASSERT_TRUE(move);
  EXPECT_NEAR(degrees_from_radians(move->turn), 1.8, error_deg);
  const auto findings = found(*move);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NE(findings[0].detail.find("turned by"), std::string::npos) << findings[0].detail;
  EXPECT_NEAR(std::get<double>(findings[0].parameters.at("turn_deg")), 1.8, error_deg);
}

// With a pose so far off, a part of the platform is taken for the object. Both errors, the pose's
// and the pattern's, are the same in both looks and cancel.
TEST(ObjectMove, DoesNotDependOnTheSensorsPatternAndARoughPose) {
  Snapshot first = first_look(figure(), wrong_pose({0.006, -0.005, 0.003}, {1, 0.5, 0}, 1.2));
  first.frame = with_pattern(std::move(first.frame));
  const auto rest = measure_move(first, with_pattern(last_look(figure())), clip);
  const auto move =
      measure_move(first, with_pattern(last_look(moved(figure(), {0.002, 0, 0}))), clip);
  ASSERT_TRUE(rest && move);
  EXPECT_TRUE(found(*rest).empty()) << found(*rest)[0].detail;
  EXPECT_NEAR(mm_from_metres(move->shift), 2, 2 * error_mm);
  EXPECT_EQ(found(*move).size(), 1U);
}

TEST(ObjectMove, IsNoTurnOfABall) {
  const Shape bead = ball({0.01, 0, 0.03}, 0.03);
  const auto move = measure_move(first_look(bead), last_look(moved(bead, {0, 0.003, 0})), clip);
  ASSERT_TRUE(move);
  EXPECT_NEAR(mm_from_metres(move->shift), 3, 2 * error_mm);
  const auto findings = found(*move);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].detail.find("turned"), std::string::npos) << findings[0].detail;
}

TEST(ObjectMove, IsTooLargeToMeasureIfTheObjectIsGone) {
  const Shape nothing = [](const Eigen::Vector3d&) { return 1.0; };
  const auto move = measure_move(first_look(figure()), last_look(nothing), clip);
  ASSERT_TRUE(move);
  const auto findings = found(*move);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NE(findings[0].detail.find("more than 20.0 mm"), std::string::npos) << findings[0].detail;
  EXPECT_EQ(findings[0].parameters, (Parameters{{"min_shift_mm", 20.0}}));
  EXPECT_FALSE(measure_move(first_look(nothing), last_look(nothing), clip));
}

TEST(ObjectMove, IsNotToldBesideWhatExplainsIt) {
  const ObjectMove move{.shift = 0.004, .shift_sigma = 0.0001};
  for (const char* const code : {"moved", "slip", "turn-not-whole"}) {
    std::vector<CalibrationFinding> findings{
        {.code = code, .detail = "", .hint = "", .stop = {}, .angle = {}, .parameters = {}}};
    add_move(findings, move);
    EXPECT_EQ(findings.size(), 1U) << code;
  }
  std::vector<CalibrationFinding> other{
      {.code = "no-map", .detail = "", .hint = "", .stop = {}, .angle = {}, .parameters = {}}};
  add_move(other, move);
  EXPECT_EQ(other.size(), 2U);
  EXPECT_TRUE(found({.shift = 0.004, .shift_sigma = 0.002}).empty()) << "uncertain";
}

TEST(ObjectMove, IsKeptInScanJsonBesideAllElse) {
  const TemporaryFolder folder;
  write_contract_scan(folder.path());
  EXPECT_FALSE(read_object_move(folder.path()));
  write_object_move(folder.path(), {.shift = 0.0021,
                                    .shift_sigma = 0.0001,
                                    .turn = radians_from_degrees(-0.5),
                                    .turn_sigma = radians_from_degrees(0.1)});
  const auto kept = read_object_move(folder.path());
  ASSERT_TRUE(kept);
  EXPECT_NEAR(kept->shift, 0.0021, 1e-12);
  EXPECT_NEAR(degrees_from_radians(kept->turn), -0.5, 1e-9);
  json document = json::parse(content_of(folder.path() / "scan.json"));
  EXPECT_NEAR(document["last_look"]["moved_mm"].get<double>(), 2.1, 1e-9);
  document.erase("last_look");
  EXPECT_EQ(document, contract);
}

TEST(ObjectMove, IsRefusedWhereScanJsonHasItWrong) {
  const TemporaryFolder folder;
  json document = contract;
  document["last_look"] = {{"moved_mm", "2"}};
  put(folder.path() / "scan.json", document.dump());
  EXPECT_EQ(code_thrown_by([&] { read_object_move(folder.path()); }), "scan-malformed");
}

}  // namespace
}  // namespace octurn
