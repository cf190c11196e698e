#include "octurn/quality.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>
#include <variant>

#include "mesh/surface_cells.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

/// The figures of a flawless scan: 24 stops by a Kinect at 0.65 m.
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
  return {.parts = 1, .unseen_share = 0.05, .volume = m3_from_mm3(300000)};
}

std::shared_ptr<const SurfaceCells> surface_at(const Eigen::Vector3d& point) {
  SurfaceCells surface;
  surface.add(point);
  return std::make_shared<SurfaceCells>(std::move(surface));
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

TEST(Judge, AllowsForTheNoiseOfTheSensor) {
  ScanFigures scan = right_scan();
  scan.distance = 0.3;
  scan.disagreement = 0.0015;
  EXPECT_EQ(codes(judge(scan, right_model())), Codes{"stops-disagree"});
  scan.sensor = sensor_traits("Intel RealSense D405");
  EXPECT_EQ(judge(scan, right_model()).verdict, Verdict::good);
  scan.disagreement = 0.0018;
  EXPECT_EQ(codes(judge(scan, right_model())), Codes{"stops-disagree"});
}

TEST(Judge, CallsAModelBadIfTheStopsDisagreeMuch) {
  ScanFigures scan = right_scan();
  scan.disagreement = 0.004;
  EXPECT_EQ(judge(scan, right_model()).verdict, Verdict::bad);
}

TEST(Judge, CallsTheModelOfAPlatformThatStoodStillBad) {
  const std::vector<CalibrationFinding> findings{{.code = "still",
                                                  .detail = "the platform did not turn",
                                                  .hint = "Look.",
                                                  .stop = {},
                                                  .angle = {},
                                                  .parameters = {}}};
  const Quality quality = judge(right_scan(), right_model(), findings);
  EXPECT_EQ(quality.verdict, Verdict::bad);
  EXPECT_EQ(codes(quality), Codes{"turntable"});
}

CalibrationFinding finding(const std::string& code, Parameters parameters = {}) {
  return {.code = code,
          .detail = "as found",
          .hint = "Look.",
          .stop = {},
          .angle = {},
          .parameters = std::move(parameters)};
}

TEST(Judge, NamesACauseAndNotWhatFollowsFromIt) {
  ScanFigures scan = right_scan();
  scan.disagreement = 0.004;
  scan.contradicted[3] = 0.4;
  scan.platform_height = 0.005;
  ModelReport model = right_model();
  model.unseen_share = 0.6;
  model.dropped.count = 3;
  model.dropped.volume = 2 * model.volume;
  EXPECT_EQ(codes(judge(scan, model)), (Codes{"stops-disagree", "floats", "little-seen"}));
  for (const auto& [found, code] :
       {std::pair("turn-ratio", "turntable"), std::pair("slip", "turntable"),
        std::pair("moved", "moved"), std::pair("alike", "alike"),
        std::pair("lasers-exchanged", "lasers-exchanged")}) {
    const std::vector<CalibrationFinding> findings{finding(found)};
    const Quality quality = judge(scan, model, findings);
    EXPECT_EQ(codes(quality), Codes{code});
    EXPECT_EQ(quality.verdict, Verdict::bad) << "the model is as bad as what follows";
  }
}

TEST(Judge, LooksAtADarkTopBeforeThePartsThatItCostTheModel) {
  ScanFigures scan = right_scan();
  scan.unseen_top = 0.035;
  ModelReport model = right_model();
  model.dropped.count = 3;
  model.dropped.volume = 0.05 * model.volume;
  const Quality quality = judge(scan, model);
  EXPECT_EQ(quality.verdict, Verdict::look);
  EXPECT_EQ(codes(quality), Codes{"top-unseen"});
  EXPECT_NE(quality.reasons[0].detail.find("35 mm above the model"), std::string::npos);
}

TEST(Judge, LowersTheSpaceForWhatLiesBelowIt) {
  ScanFigures scan = right_scan();
  scan.object_pixels = 40;
  scan.below.pixels = 1200;
  scan.below.noise_end = 0.002;
  const Quality quality = judge(scan, {});
  EXPECT_EQ(quality.verdict, Verdict::bad);
  EXPECT_EQ(codes(quality), Codes{"too-low"});
  scan.below.noise_end = -0.003;
  EXPECT_EQ(codes(judge(scan, {})), Codes{"empty"}) << "a pose that is off is no low object";
  scan.below.noise_end = 0.002;
  scan.below.pixels = 60;
  EXPECT_EQ(codes(judge(scan, {})), Codes{"empty"});
}

TEST(Judge, MentionsAFilledHollowOfAGoodModel) {
  ScanFigures scan = right_scan();
  ModelReport model = right_model();
  const auto surface = std::make_shared<SurfaceCells>();
  model.places.surface = surface;
  for (int i = 0; i < 64; ++i) {  // a wall, 60 mm high, around a floor 25 mm up
    const double angle = 2 * std::numbers::pi * i / 64;
    for (double z = 0.0025; z < 0.06; z += 0.005) {
      scan.seen.emplace_back(0.04 * std::cos(angle), 0.04 * std::sin(angle), z);
      surface->add(scan.seen.back());
    }
    model.places.unseen.emplace_back(0.02 * std::cos(angle), 0.02 * std::sin(angle), 0.025);
  }
  const Quality quality = judge(scan, model);
  EXPECT_EQ(quality.verdict, Verdict::good);
  ASSERT_EQ(codes(quality), Codes{"hollow-filled"});
  EXPECT_NEAR(std::get<double>(quality.reasons[0].parameters.at("hollow_mm")), 32.5, 0.1);
  std::erase_if(scan.seen, [](const Eigen::Vector3d& seen) { return seen.x() > 0; });
  EXPECT_EQ(judge(scan, model), Quality{}) << "a slope behind which nothing was seen is no hollow";
}

TEST(Judge, LooksAtAShellThatIsThickerThanNoiseMakesIt) {
  ScanFigures scan = right_scan();
  ModelReport model = right_model();
  model.leaves = 300000;  // of 1 mm
  model.places.leaves = {{0, 0, 0}};
  scan.shell.swelling = 0.0027;
  EXPECT_EQ(judge(scan, model), Quality{});
  scan.shell.swelling = 0.0030;
  Quality quality = judge(scan, model);
  EXPECT_EQ(quality.verdict, Verdict::look);
  ASSERT_EQ(codes(quality), Codes{"swollen"});
  EXPECT_EQ(quality.reasons[0].parameters, (Parameters{{"swelling_mm", 3.0}}));
  EXPECT_EQ(quality.reasons[0].hint, "Build the model again with the method solid.");
  scan.distance = 0.9;
  EXPECT_EQ(judge(scan, model), Quality{}) << "noise grows with the square of the distance";
  scan.shell.stray_share = 0.03;
  quality = judge(scan, model);
  ASSERT_EQ(codes(quality), Codes{"swollen"});
  EXPECT_EQ(quality.reasons[0].parameters, (Parameters{{"stray_share", 0.03}}));
}

TEST(Judge, LooksAtAShellWhoseStrayPiecesMakeItLarger) {
  ScanFigures scan = right_scan();
  scan.below.noise_end = 0.002;
  scan.seen = {{-0.08, 0, 0.05}, {0.08, 0, 0.05}, {0.14, 0, 0.0025}};  // the last is noise
  ModelReport model = right_model();
  model.places.surface = surface_at({0, 0, 0.05});
  model.places.leaves = {{0, 0, 0}};
  model.size = {0.175, 0.02, 0.06};
  EXPECT_EQ(judge(scan, model), Quality{});
  model.size.x() = 0.219;
  const Quality quality = judge(scan, model);
  EXPECT_EQ(quality.verdict, Verdict::look);
  ASSERT_EQ(codes(quality), Codes{"swollen"});
  EXPECT_EQ(quality.reasons[0].detail.find("stray pieces make the model 54.0 mm larger"), 0U);
  model.places.leaves.clear();
  EXPECT_EQ(judge(scan, model), Quality{}) << "of a solid, other parts are dropped";
}

TEST(Judge, LooksAtAFileOfAShellThatFewSlicersOpen) {
  ModelReport model = right_model();
  model.bytes = 227'000'000;
  EXPECT_EQ(judge(right_scan(), model), Quality{}) << "a solid has the triangles that it needs";
  model.places.leaves = {{0, 0, 0}};
  const Quality quality = judge(right_scan(), model);
  EXPECT_EQ(quality.verdict, Verdict::look);
  ASSERT_EQ(codes(quality), Codes{"large-file"});
  EXPECT_EQ(quality.reasons[0].parameters, (Parameters{{"file_mb", 227.0}}));
}

TEST(Judge, AsksForMoreSnapshotsIfThereWereTwo) {
  ScanFigures scan = right_scan();
  scan.widest_gap = radians_from_degrees(180);
  scan.stops = 2;
  EXPECT_EQ(judge(scan, right_model()).reasons.front().hint, "Scan with more snapshots.");
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

TEST(Judge, TellsOfFillFarFromEverythingThatWasSeen) {
  ScanFigures scan = right_scan();
  scan.sensor.sees_lines = true;
  scan.seen = {{0, 0, 0.02}, {0.03, 0, 0.02}};
  ModelReport model = right_model();
  model.places.unseen = {{0.055, 0, 0.02}, {-0.02, 0, 0.02}};  // 25 and 20 mm away
  EXPECT_EQ(judge(scan, model), Quality{});
  model.places.unseen.push_back({0, 0.06, 0.02});
  const Quality quality = judge(scan, model);
  ASSERT_EQ(codes(quality), Codes{"filled-far"});
  EXPECT_EQ(quality.reasons[0].places, std::vector<Eigen::Vector3d>{model.places.unseen.back()});
  EXPECT_NEAR(std::get<double>(quality.reasons[0].parameters.at("fill_mm")), 60, 1e-9);
  scan.sensor.sees_lines = false;
  EXPECT_EQ(judge(scan, model), Quality{}) << "a depth sensor does not see below a ball";
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
  model.dropped.count = 3;
  model.dropped.volume = 0.05 * model.volume;
  const Quality dropped = judge(right_scan(), model);
  ASSERT_EQ(codes(dropped), Codes{"parts-dropped"});
  EXPECT_EQ(dropped.reasons[0].detail.find("3 parts, 15.0 cm3 in all"), 0U);
  model.dropped.count = 400;  // of the platform's noise
  EXPECT_EQ(judge(right_scan(), model).verdict, Verdict::good);
  model.dropped.volume = 0.001 * model.volume;  // a speck
  EXPECT_EQ(judge(right_scan(), model).verdict, Verdict::good);
}

/// Adds the cells of a limb, 6 cm long and 2 cm wide, above the model.
void add_seen_limb(ScanFigures& scan) {
  for (double z = 0.1; z < 0.16; z += 0.005) {
    for (double x = 0; x < 0.02; x += 0.005) {
      scan.seen.emplace_back(x, 0, z);
    }
  }
}

TEST(Judge, TellsOfAPartThatWasSeenAndIsNotInTheModel) {
  ScanFigures scan = right_scan();
  add_seen_limb(scan);
  ModelReport model = right_model();
  model.places.surface = surface_at(Eigen::Vector3d(0, 0, 0.05));
  const Quality quality = judge(scan, model);
  EXPECT_EQ(quality.verdict, Verdict::look);
  ASSERT_EQ(codes(quality), Codes{"part-missing"});
  EXPECT_NE(quality.reasons[0].detail.find("60.0 mm"), std::string::npos)
      << quality.reasons[0].detail;
  EXPECT_FALSE(quality.reasons[0].places.empty());
}

TEST(Judge, ShowsWherePartsWereDropped) {
  ScanFigures scan = right_scan();
  add_seen_limb(scan);
  ModelReport model = right_model();
  model.dropped.volume = 0.05 * model.volume;
  const Quality quality = judge(scan, model);
  ASSERT_EQ(codes(quality), Codes{"parts-dropped"});
  EXPECT_FALSE(quality.reasons[0].places.empty());
}

TEST(Judge, LooksAtEachPoseOfSeveral) {
  std::vector<ScanFigures> poses(3, right_scan());
  EXPECT_EQ(judge(poses, right_model()), Quality{});
  poses[1].platform_height = 0.02;
  poses[2].cut_pixels[4] = 20;
  poses[2].platform_height = 0.02;
  const Quality quality = judge(poses, right_model());
  EXPECT_EQ(quality.verdict, Verdict::bad);
  ASSERT_EQ(codes(quality), Codes{"floats"});  // each code once
  EXPECT_EQ(quality.reasons.front().detail.find("side 2: the platform is seen 20"), 0U);
}

TEST(Judge, MissesAPartThatOnlyTheUndersidesScanSaw) {
  std::vector<ScanFigures> poses(2, right_scan());
  add_seen_limb(poses[1]);
  ModelReport model = right_model();
  model.places.surface = surface_at(Eigen::Vector3d(0, 0, 0.05));
  const Quality quality = judge(poses, model);
  ASSERT_EQ(codes(quality), Codes{"part-missing"});
  EXPECT_EQ(quality.reasons[0].detail.find("side 2: a part of the object, 60.0 mm"), 0U);
  EXPECT_FALSE(quality.reasons[0].places.empty());
}

TEST(Judge, CallsASideUnseenOnlyIfNoPoseWasTurnedAllAround) {
  std::vector<ScanFigures> poses(2, right_scan());
  poses[0].widest_gap = radians_from_degrees(180);
  EXPECT_EQ(judge(poses, right_model()), Quality{});
  poses[1].widest_gap = radians_from_degrees(120);
  const Quality quality = judge(poses, right_model());
  ASSERT_EQ(codes(quality), Codes{"little-seen"});
  EXPECT_EQ(quality.verdict, Verdict::look);
}

TEST(Judge, TellsTheValuesOfAReasonAsItsDetailDoes) {
  ScanFigures scan = right_scan();
  scan.disagreement = 0.004;
  Quality quality = judge(scan, right_model());
  ASSERT_EQ(codes(quality), Codes{"stops-disagree"});
  EXPECT_EQ(quality.reasons[0].parameters, (Parameters{{"disagreement_mm", 4.0}}));
  EXPECT_NE(quality.reasons[0].detail.find(" 4.0 mm"), std::string::npos);
  scan.disagreement = 0;
  scan.contradicted = {0, 0, 0.25};
  quality = judge(scan, right_model());
  ASSERT_EQ(codes(quality), Codes{"moved"});
  EXPECT_EQ(quality.reasons[0].parameters, (Parameters{{"stop", 2.0}, {"empty_share", 0.25}}));
}

TEST(Judge, TakesOverWhatTheCalibrationFound) {
  const std::vector<CalibrationFinding> findings{{.code = "moved",
                                                  .detail = "the object moved",
                                                  .hint = "Fix it.",
                                                  .stop = {},
                                                  .angle = {},
                                                  .parameters = {}},
                                                 {.code = "slip",
                                                  .detail = "at stop 5",
                                                  .hint = "Look.",
                                                  .stop = 5,
                                                  .angle = 0.03,
                                                  .parameters = {{"stop", 5.0}, {"off_deg", 1.7}}},
                                                 {.code = "no-map",
                                                  .detail = "not flat",
                                                  .hint = "Flatten.",
                                                  .stop = {},
                                                  .angle = {},
                                                  .parameters = {}}};
  const Quality quality = judge(right_scan(), right_model(), findings);
  ASSERT_EQ(codes(quality), (Codes{"moved", "turntable"}));
  EXPECT_EQ(quality.reasons[0].parameters, Parameters{});
  EXPECT_EQ(quality.reasons[1].parameters, findings[1].parameters);
}

TEST(Judge, AsksToLookAtAModelWhoseOpticsAreKnownToBeOff) {
  const std::vector<CalibrationFinding> findings{{.code = "optics",
                                                  .detail = "sizes may be wrong by 2.1 %",
                                                  .parameters = {{"size_share", 0.021}}}};
  const Quality quality = judge(right_scan(), right_model(), findings);
  EXPECT_EQ(quality.verdict, Verdict::look);
  EXPECT_EQ(codes(quality), Codes{"optics"});
  EXPECT_EQ(quality.reasons.front().parameters, findings.front().parameters);
}

/// Optics with that focal length and sigma, pixels.
SolvedOptics optics_of(double focal, double sigma) {
  return {.value = {.fx = focal, .fy = focal}, .sigma = {.fx = sigma, .fy = sigma}};
}

/// A scan of a sensor of 576 pixels with a map.
Scan mapped_scan() {
  return {.intrinsics = {.fx = 576, .fy = 576},
          .shots = {Shot{}},
          .sensor_map = std::make_shared<SensorMap>()};
}

/// The expected error of 150 mm, in millimetres.
double error_of_150_mm(const Scan& scan, const std::optional<SolvedOptics>& seen = {}) {
  const auto size = expected_size_error(scan, {0.09, 0.15, 0.03}, seen);
  EXPECT_TRUE(size);
  EXPECT_EQ(size->length, 0.15);
  return mm_from_metres(size->error);
}

TEST(SizeError, IsTheSpreadOfPublishedSensorsUntilSomethingWasMeasured) {
  // Two sigma of 1 % in scale and 1.5 % in focal length.
  EXPECT_NEAR(error_of_150_mm(mapped_scan()), 2 * 1.803e-2 * 150, 0.03);
}

TEST(SizeError, ShrinksWithAKnownLengthAndMeasuredOptics) {
  Scan scan = mapped_scan();
  scan.optics = optics_of(590, 0.59);
  const double unknown_scale = error_of_150_mm(scan);
  EXPECT_NEAR(unknown_scale, 2 * 0.01 * 150, 0.05);
  scan.scale_sigma = 0.0015;
  EXPECT_NEAR(error_of_150_mm(scan), 2 * std::hypot(150 * std::hypot(0.001, 0.0015), 0.12), 0.01);
  scan.sensor_map.reset();
  EXPECT_GT(error_of_150_mm(scan), 2 * 0.3) << "the sensor's pattern";
  scan.solved = SolvedPose{.optics = optics_of(590, 5.9)};
  EXPECT_GT(error_of_150_mm(scan), 3) << "solved optics are those of the model";
}

TEST(SizeError, CountsWhatATurnSawOfTheOpticsWhetherItIsAppliedOrNot) {
  Scan scan = mapped_scan();
  scan.scale_sigma = 0;
  EXPECT_LT(error_of_150_mm(scan, optics_of(576.5, 0.6)), 0.6) << "the data sheet is right";
  EXPECT_NEAR(error_of_150_mm(scan, optics_of(587.5, 0.6)), 2 * 0.02 * 150, 0.05);
}

TEST(SizeError, IsStatedOfDepthSensorsOnAPlatformOnly) {
  Scan scan = mapped_scan();
  scan.laser = LaserCamera{};
  EXPECT_FALSE(expected_size_error(scan, {0.1, 0.1, 0.1}));
  scan = mapped_scan();
  scan.shots.front().object_from_sensor = Eigen::Isometry3d::Identity();
  EXPECT_FALSE(expected_size_error(scan, {0.1, 0.1, 0.1}));
}

TEST(SizeError, OfTurnsMadeIntoOneModelIsThatOfTheWorst) {
  Scan scan = mapped_scan();
  scan.optics = optics_of(590, 0.59);
  scan.poses = {ScanPose{}, ScanPose{}};
  const double known = error_of_150_mm(scan);
  scan.poses[1].solved = SolvedPose{.optics = optics_of(590, 11.8)};
  EXPECT_GT(error_of_150_mm(scan), known + 2);
}

/// The codes of a verdict's reasons, of a scan and a map with a sensor that was on for so long.
Codes codes_of_warm_up(std::optional<double> scan_s, std::optional<double> map_s) {
  Scan scan{.sensor_on_for = scan_s};
  scan.sensor_map = std::make_shared<SensorMap>(SensorMap{.on_for = map_s});
  Quality quality;
  add_warm_up(quality, scan);
  EXPECT_EQ(quality.verdict, Verdict::good);
  return codes(quality);
}

TEST(WarmUp, IsMentionedIfScanAndMapDifferByMoreThanFiveMinutes) {
  EXPECT_EQ(codes_of_warm_up(20, 620), Codes{"warm-up"});
  EXPECT_EQ(codes_of_warm_up(4000, 620), Codes{"warm-up"});
  EXPECT_EQ(codes_of_warm_up(400, 620), Codes{});
  EXPECT_EQ(codes_of_warm_up(9000, 1800), Codes{}) << "both warm";
  EXPECT_EQ(codes_of_warm_up({}, 620), Codes{});
  EXPECT_EQ(codes_of_warm_up(20, {}), Codes{});
  Quality without_map;
  add_warm_up(without_map, Scan{.sensor_on_for = 20});
  EXPECT_TRUE(without_map.reasons.empty());
}

TEST(WarmUp, IsSaidInMinutes) {
  Scan scan{.sensor_on_for = 20};
  scan.sensor_map = std::make_shared<SensorMap>(SensorMap{.on_for = 620});
  Quality quality;
  add_warm_up(quality, scan);
  EXPECT_EQ(quality.reasons.front().parameters, (Parameters{{"map_min", 10.0}, {"scan_min", 0.0}}));
}

}  // namespace
}  // namespace octurn
