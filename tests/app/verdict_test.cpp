// A scan's verdict on its model where something went wrong, as the HTTP interface reports it.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "app/scanner_fixture.hpp"
#include "app/simulated_frames.hpp"
#include "http/scan_json.hpp"

namespace octurn {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr int verdict_stops = 8;

/// The frames of all stops, with half a real sensor's noise, as four averaged frames have.
using Seen = std::array<DepthFrame, verdict_stops>;

/// @param misalignment  deviation from the told pose, as a multiple of 5 mm and 1 degree
Seen seen(std::vector<AlignedBox3d> boxes, double misalignment = 0) {
  // The simulator centres the bounding box of all boxes on the axis; two specks, too small for a
  // pixel, keep that box in place.
  const Vector3d speck(0.01, 0.01, 0.01);
  const Vector3d corner(90, 90, 0);
  boxes.emplace_back(-corner, -corner + speck);
  boxes.emplace_back(corner - speck, corner);
  const BoxesOnPlatform on_platform(boxes);
  Simulation simulation = parse_simulation(on_platform.uri(0.5, 50));
  simulation.misalignment = misalignment;
  const auto sensor = open_sensor(simulation_uri(simulation));
  Seen frames;
  for (int stop = 0; stop < verdict_stops; ++stop) {
    // 0.6 radians askew, so that no wall faces the sensor.
    frames[static_cast<std::size_t>(stop)] =
        frame_at(*sensor, 2 * std::numbers::pi * stop / verdict_stops + 0.6).frame;
  }
  return frames;
}

/// An asymmetric object of 8 cm.
std::vector<AlignedBox3d> object() {
  return {AlignedBox3d(Vector3d(-30, -25, 0), Vector3d(25, 20, 40)),
          AlignedBox3d(Vector3d(-5, -15, 40), Vector3d(20, 10, 80))};
}

const Seen& object_seen() {
  static const Seen frames = seen(object());
  return frames;
}

/// A sensor with a given frame for each look: one look at each stop, and the last look at the
/// first.
class SensorOfLooks final : public DepthSensor {
 public:
  explicit SensorOfLooks(std::function<DepthFrame(int look)> see) : see_(std::move(see)) {}

  const std::string& name() const override { return name_; }
  const Intrinsics& intrinsics() const override { return lens_; }
  std::string serial() const override { return {}; }
  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    if (stop.stop_requested()) {
      return std::nullopt;
    }
    return TimedFrame{.frame = see_(look_), .time = std::chrono::steady_clock::now()};
  }
  std::optional<Tilt> tilt() const override { return std::nullopt; }
  std::optional<PacketCounts> packet_counts() const override { return std::nullopt; }
  void show_angle(double angle) override {
    const double stop = angle * verdict_stops / (2 * std::numbers::pi);
    const double nearest = std::round(stop);
    if (std::abs(stop - nearest) < 0.01 &&
        static_cast<int>(nearest) % verdict_stops != look_ % verdict_stops) {
      ++look_;  // the platform reached another stop
    }
  }

 private:
  std::function<DepthFrame(int look)> see_;
  int look_ = 0;
  std::string name_ = "sensor of a test";
  Intrinsics lens_ = {};
};

/// A scan's quality reasons with a code.
std::vector<json> reasons(const json& scan, const std::string& code) {
  std::vector<json> found;
  std::ranges::copy_if(scan["model"]["quality"]["reasons"], std::back_inserter(found),
                       [&](const json& reason) { return reason["code"] == code; });
  return found;
}

class VerdictTest : public ScannerTest {
 protected:
  /// Runs a scan to its end. @return the scan as the HTTP interface shows it
  json scan_of(const std::function<DepthFrame(int look)>& see,
               const Box& clip = ScanSettings().clip,
               double leaf_size = few_snapshots().leaf_size) {
    const auto open = [&](const std::string& /*uri*/) {
      return std::make_unique<SensorOfLooks>(see);
    };
    Scanner scanner({.speed = 1000, .open_sensor = open}, {}, store_);
    ScanSettings settings = few_snapshots(verdict_stops);
    settings.frames = 1;
    settings.clip = clip;
    settings.leaf_size = leaf_size;
    return to_json(scan(scanner, settings));
  }

  static DepthFrame at(const Seen& frames, int look) {
    return frames[static_cast<std::size_t>(look % verdict_stops)];
  }
};

TEST_F(VerdictTest, IsGoodWhereNothingWentWrong) {
  const json scan = scan_of([](int look) { return at(object_seen(), look); });
  const json& quality = scan["model"]["quality"];
  EXPECT_EQ(quality["verdict"], "good") << scan;
  EXPECT_EQ(quality["reasons"], json::array()) << scan;
  EXPECT_GT(quality["size_error"]["mm"], 0) << "an unknown scale is no reason against good";
}

TEST_F(VerdictTest, SaysThatTheScannedSpaceBeheadsTheObject) {
  Box low = ScanSettings().clip;
  low.max.z() = 0.06;  // the object is 8 cm high
  const json scan = scan_of([](int look) { return at(object_seen(), look); }, low);
  EXPECT_EQ(scan["model"]["quality"]["verdict"], "look") << scan;
  const auto cut = reasons(scan, "cut-by-box");
  ASSERT_EQ(cut.size(), 1U) << scan;
  EXPECT_EQ(cut[0]["detail"], "the object reaches through the top of the scanned space");
  EXPECT_EQ(cut[0]["hint"], "Make the scanned space larger, or move the object.");
  ASSERT_FALSE(cut[0]["places_mm"].empty()) << scan;
  for (const json& place : cut[0]["places_mm"]) {
    EXPECT_NEAR(place[2].get<double>(), 60, 8);  // a cell and a pixel
  }
}

TEST_F(VerdictTest, IsTheErrorOfAScanOfAnEmptyPlatform) {
  const Seen nothing = seen({});
  const json scan = scan_of([&](int look) { return at(nothing, look); });
  EXPECT_EQ(scan["model"], nullptr) << scan;
  EXPECT_EQ(scan["state"], "failed");
  EXPECT_EQ(scan["error"]["code"], "empty");
  EXPECT_EQ(scan["error"]["detail"], "no surface in the clip box: there is nothing to write");
  EXPECT_TRUE(scan["error"]["hint"].get<std::string>().starts_with(
      "Stand the object on the platform's middle"));
  EXPECT_TRUE(scan["calibration"]["reason"].get<std::string>().starts_with(
      "too little of an object is seen"));
}

TEST_F(VerdictTest, LetsTheSpaceBeginWhereThePlatformsNoiseEndsForATile) {
  const Seen tile = seen({AlignedBox3d(Vector3d(-40, -40, 0), Vector3d(40, 40, 4))});
  const json scan = scan_of([&](int look) { return at(tile, look); }, ScanSettings().clip, 0.001);
  ASSERT_EQ(scan["state"], "finished") << scan;
  EXPECT_EQ(scan["model"]["quality"]["verdict"], "good") << scan;
  EXPECT_NEAR(scan["model"]["size_mm"][2].get<double>(), 4, 1) << scan;
  const double bottom = scan["settings"]["clip_mm"][2].get<double>();
  EXPECT_LT(bottom, 4);
  EXPECT_GT(bottom, 0.5);
  const Scan stored = read_scan(store_.folder(scan["id"].get<std::string>()));
  EXPECT_NEAR(mm_from_metres(stored.clip.min.z()), bottom, 0.001);
}

TEST_F(VerdictTest, LowersNoSpaceWhoseBottomSomebodyChose) {
  const Seen tile = seen({AlignedBox3d(Vector3d(-40, -40, 0), Vector3d(40, 40, 4))});
  Box chosen = ScanSettings().clip;
  chosen.min.z() = 0.007;
  const json scan = scan_of([&](int look) { return at(tile, look); }, chosen);
  EXPECT_EQ(scan["settings"]["clip_mm"][2], 7) << scan;
  EXPECT_EQ(scan["state"], "failed") << scan;
  EXPECT_EQ(scan["error"]["detail"], "what lies on the platform is lower than the scanned space");
}

TEST_F(VerdictTest, SaysThatTheRigWasBumpedInMidScan) {
  const Seen bumped = seen(object(), 0.9);  // 0.9 degrees; the platform's centre sinks by 1.8 mm
  const json scan = scan_of(
      [&](int look) { return at(look < verdict_stops / 2 ? object_seen() : bumped, look); });
  EXPECT_NE(scan["model"]["quality"]["verdict"], "good") << scan;
  const auto moved = reasons(scan, "moved");
  ASSERT_EQ(moved.size(), 1U) << scan;
  EXPECT_EQ(
      moved[0]["detail"],
      "between stops 3 and 4 the sensor moved: the platform tilts by 0.9 degrees and sinks by "
      "1.8 mm as it sees it");
  EXPECT_EQ(moved[0]["hint"], "Fix the sensor and the platform, calibrate, and scan again.");
  EXPECT_TRUE(reasons(scan, "stops-disagree").empty()) << "it follows from the move: " << scan;
}

TEST_F(VerdictTest, SolvesNoPoseWhereTheRigWasBumpedByACentimetre) {
  const Seen bumped = seen(object(), 2);
  const json scan = scan_of(
      [&](int look) { return at(look < verdict_stops / 2 ? object_seen() : bumped, look); });
  EXPECT_NE(scan["model"]["quality"]["verdict"], "good") << scan;
  ASSERT_EQ(reasons(scan, "moved").size(), 1U) << scan;
  EXPECT_EQ(scan["calibration"]["accepted"], false) << scan;
  EXPECT_EQ(scan["calibration"]["reason"], reasons(scan, "moved")[0]["detail"]);
}

TEST_F(VerdictTest, NamesTheStopWithAHandInThePicture) {
  std::vector<AlignedBox3d> with_hand = object();
  with_hand.emplace_back(Vector3d(45, 30, 20), Vector3d(85, 85, 60));
  const Seen hand = seen(with_hand);
  const json scan = scan_of([&](int look) { return at(look == 3 ? hand : object_seen(), look); });
  EXPECT_EQ(scan["model"]["quality"]["verdict"], "look") << scan;
  const auto moved = reasons(scan, "moved");
  ASSERT_EQ(moved.size(), 1U) << scan;
  const auto detail = moved[0]["detail"].get<std::string>();
  EXPECT_TRUE(detail.starts_with("at stop 3 ")) << detail;
  EXPECT_TRUE(detail.ends_with("of what was seen lies where other stops saw empty space"))
      << detail;
  EXPECT_EQ(moved[0]["hint"], "Keep hands out of the picture, and check that nothing moves.");
}

}  // namespace
}  // namespace octurn
