#include "octurn/quality.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "octurn/units.hpp"

namespace octurn {
namespace {

/// A scan of 24 stops as a Kinect at 0.65 m gives it.
ScanFigures right_scan() {
  return {.stops = 24,
          .object_pixels = 9000,
          .distance = 0.65,
          .widest_gap = radians_from_degrees(15),
          .cut_pixels = {},
          .platform_height = 0.0003,
          .disagreement = 0.0006,
          .contradicted = std::vector<double>(24, 0.01)};
}

ModelReport right_model() {
  return {.parts = 1, .unseen_share = 0.05, .volume = m3_from_mm3(300000), .dropped_volume = 0};
}

std::vector<std::string> codes(const Quality& quality) {
  std::vector<std::string> codes;
  std::ranges::transform(quality.reasons, std::back_inserter(codes), &QualityReason::code);
  return codes;
}

using Codes = std::vector<std::string>;

TEST(Judge, CallsAModelOfARightScanGood) {
  EXPECT_EQ(judge(right_scan(), right_model()), Quality{});
}

TEST(Judge, CallsAModelOfAnEmptyPlatformBadAndSaysNothingElseOfIt) {
  ScanFigures scan = right_scan();
  scan.object_pixels = 40;
  scan.disagreement = 0.01;
  const Quality quality = judge(scan, right_model());
  EXPECT_EQ(quality.verdict, Verdict::bad);
  EXPECT_EQ(codes(quality), Codes{"empty"});
}

TEST(Judge, AllowsForANoiseThatGrowsWithTheSquareOfTheDistance) {
  ScanFigures scan = right_scan();
  scan.disagreement = 0.0020;
  EXPECT_EQ(codes(judge(scan, right_model())), Codes{"stops-disagree"});
  scan.distance = 1.0;
  EXPECT_EQ(judge(scan, right_model()).verdict, Verdict::good);
}

TEST(Judge, CallsAModelBadIfTheStopsDisagreeMuch) {
  ScanFigures scan = right_scan();
  scan.disagreement = 0.004;
  EXPECT_EQ(judge(scan, right_model()).verdict, Verdict::bad);
}

TEST(Judge, NamesTheStopThatSawWhatOthersSawThrough) {
  ScanFigures scan = right_scan();
  scan.contradicted[7] = 0.3;
  const Quality quality = judge(scan, right_model());
  ASSERT_EQ(codes(quality), Codes{"moved"});
  EXPECT_NE(quality.reasons[0].detail.find("stop 7"), std::string::npos);
}

TEST(Judge, TellsAPlatformTooHighFromOneTooLow) {
  ScanFigures scan = right_scan();
  scan.platform_height = 0.005;
  EXPECT_EQ(codes(judge(scan, right_model())), Codes{"floats"});
  scan.platform_height = -0.005;
  EXPECT_EQ(codes(judge(scan, right_model())), Codes{"sunk"});
  scan.platform_height = {};
  EXPECT_EQ(judge(scan, right_model()).verdict, Verdict::good);
}

TEST(Judge, LooksForASideThatNobodySaw) {
  ScanFigures scan = right_scan();
  scan.widest_gap = radians_from_degrees(180);
  EXPECT_EQ(codes(judge(scan, right_model())), Codes{"little-seen"});
  EXPECT_EQ(judge(scan, right_model()).verdict, Verdict::bad);
  ModelReport model = right_model();
  model.unseen_share = 0.4;
  EXPECT_EQ(codes(judge(right_scan(), model)), Codes{"little-seen"});
}

TEST(Judge, NamesTheSideOfTheBoxThatCutsTheObject) {
  ScanFigures scan = right_scan();
  scan.cut_pixels = {0, 0, 0, 0, 30};
  scan.cut_places[4] = {{0.01, 0.02, 0.09}};
  const Quality quality = judge(scan, right_model());
  ASSERT_EQ(codes(quality), Codes{"cut-by-box"});
  EXPECT_NE(quality.reasons[0].detail.find("the top"), std::string::npos);
  EXPECT_EQ(quality.reasons[0].places, scan.cut_places[4]);
}

TEST(Judge, TellsOfPartsThatWereDropped) {
  ModelReport model = right_model();
  model.dropped_volume = 0.05 * model.volume;
  EXPECT_EQ(codes(judge(right_scan(), model)), Codes{"parts-dropped"});
  model.dropped_volume = 0.001 * model.volume;  // a speck
  EXPECT_EQ(judge(right_scan(), model).verdict, Verdict::good);
}

TEST(Judge, TakesOverWhatTheCalibrationFound) {
  const std::vector<CalibrationFinding> findings{
      {.code = "moved", .detail = "the object moved", .hint = "Fix it.", .stop = {}, .angle = {}},
      {.code = "slip", .detail = "at stop 5", .hint = "Look.", .stop = 5, .angle = 0.03},
      {.code = "no-map", .detail = "not flat", .hint = "Flatten.", .stop = {}, .angle = {}}};
  EXPECT_EQ(codes(judge(right_scan(), right_model(), findings)),
            (Codes{"moved", "stops-disagree"}));
}

}  // namespace
}  // namespace octurn
