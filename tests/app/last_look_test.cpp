// The last look: one more frame at the first stop, after all snapshots of a scan are taken.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "app/faulty_rig.hpp"
#include "app/few_snapshots.hpp"
#include "app/simulated_frames.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/scan_folder.hpp"
#include "run/run_scan.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using Eigen::AlignedBox3d;
using Eigen::Vector3d;

/// Two blocks, moved by `by` (millimetres). The simulator centres the bounding box of everything on
/// the axis; two fixed specks, too small for a pixel, keep that box in place.
BoxesOnPlatform blocks_moved(const Vector3d& by) {
  const auto at = [&](const Vector3d& min, const Vector3d& max) {
    return AlignedBox3d(min + by, max + by);
  };
  const Vector3d speck(0.01, 0.01, 0.01);
  const Vector3d corner(90, 90, 0);
  return BoxesOnPlatform({at({-30, -25, 0}, {25, 20, 40}), at({-5, -15, 40}, {20, 10, 80}),
                          AlignedBox3d(-corner, -corner + speck),
                          AlignedBox3d(corner - speck, corner)});
}

constexpr int look_stops = 8;

/// A simulated sensor with a Kinect's noise and pattern, whose object is moved after some looks.
class SensorOfMovedObject final : public DepthSensor {
 public:
  static constexpr double speed = 20;
  static constexpr double askew = 0.6;  // radians: shows two walls, which fix both directions

  /// @param looks  number of stops before the object is moved
  SensorOfMovedObject(const Vector3d& by, int looks)
      : before_(blocks_moved(Vector3d::Zero())),
        after_(blocks_moved(by)),
        looks_(looks),
        sensor_(open(before_)) {}

  const std::string& name() const override { return sensor_->name(); }
  const Intrinsics& intrinsics() const override { return sensor_->intrinsics(); }
  std::string serial() const override { return sensor_->serial(); }
  std::optional<TimedFrame> read(const std::stop_token& stop) override {
    return sensor_->read(stop);
  }
  std::optional<Tilt> tilt() const override { return sensor_->tilt(); }
  std::optional<PacketCounts> packet_counts() const override { return sensor_->packet_counts(); }
  void show_angle(double angle) override {
    const double stop = angle * look_stops / (2 * std::numbers::pi);
    const auto nearest = static_cast<int>(std::lround(stop));
    if (std::abs(stop - nearest) < 0.01 && std::exchange(stop_, nearest) != nearest &&
        looks_-- == 0) {
      sensor_ = open(after_);
    }
    sensor_->show_angle(angle + askew);
  }

 private:
  static std::unique_ptr<DepthSensor> open(const BoxesOnPlatform& boxes) {
    Simulation simulation = parse_simulation(boxes.uri(1, speed));
    simulation.pattern = 1;
    return open_sensor(simulation_uri(simulation));
  }

  BoxesOnPlatform before_;
  BoxesOnPlatform after_;
  int looks_;
  int stop_ = -1;  // the platform's last stop
  std::unique_ptr<DepthSensor> sensor_;
};

ScanSettings eight_stops(PoseSource pose) {
  ScanSettings settings = few_snapshots(look_stops);
  settings.pose = pose;
  return settings;
}

std::optional<Model> scan(const Vector3d& by, int looks, PoseSource pose, const fs::path& folder) {
  Rig rig({.speed = SensorOfMovedObject::speed, .open_sensor = [&](const std::string&) {
             return std::make_unique<SensorOfMovedObject>(by, looks);
           }});
  return run_scan(eight_stops(pose), {}, folder, *make_capture(rig), {}, {});
}

std::vector<std::string> moves_told(const Model& model) {
  std::vector<std::string> details;
  for (const QualityReason& reason : model.quality.value().reasons) {
    if (reason.code == "moved") {
      details.push_back(reason.detail);
    }
  }
  return details;
}

/// The move that the last look found, if any.
std::string move_told(const Model& model) {
  for (const std::string& detail : moves_told(model)) {
    if (detail.find("one more look") != std::string::npos) {
      return detail;
    }
  }
  return {};
}

TEST(LastLook, TellsByHowMuchTheObjectMovedInMidScan) {
  const TemporaryFolder folder;
  const auto model = scan({1.5, -1.5, 0}, look_stops / 2, PoseSource::configured, folder.path());
  ASSERT_TRUE(model);
  const std::string detail = move_told(*model);
  ASSERT_NE(detail.find("moved by "), std::string::npos);
  EXPECT_NEAR(std::stod(detail.substr(detail.find("moved by ") + 9)), 2.1, 0.4) << detail;
  EXPECT_EQ(model->quality->verdict, Verdict::look);
  EXPECT_TRUE(read_object_move(folder.path()));
}

TEST(LastLook, SeesAMoveAfterTheLastStopThatNoSnapshotShows) {
  const TemporaryFolder folder;
  const auto model = scan({2.1, 0, 0}, look_stops, PoseSource::solved, folder.path());
  ASSERT_TRUE(model);
  EXPECT_NE(move_told(*model).find("moved by "), std::string::npos);
}

TEST(LastLook, TellsNothingOfAnObjectAtRest) {
  for (const PoseSource pose : {PoseSource::configured, PoseSource::solved}) {
    const TemporaryFolder folder;
    const auto model = scan({0, 0, 0}, look_stops / 2, pose, folder.path());
    ASSERT_TRUE(model);
    EXPECT_EQ(moves_told(*model), std::vector<std::string>());
    const auto move = read_object_move(folder.path());
    ASSERT_TRUE(move);
    EXPECT_LT(mm_from_metres(move->shift), 0.5);
  }
}

TEST(LastLook, IsInNoModelAndInNoSnapshot) {
  const TemporaryFolder folder;
  ASSERT_TRUE(scan({0, 0, 0}, look_stops, PoseSource::configured, folder.path()));
  const std::string model = content_of(folder.path() / "Scan.stl");
  EXPECT_EQ(read_scan(folder.path()).shots.size(), std::size_t{look_stops});
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path() / "snapshots"), {}), look_stops);

  // A scan that was killed before its model was made has stored the last look's result, and makes
  // the model without a sensor.
  fs::remove(folder.path() / "Scan.stl");
  const std::string description = content_of(folder.path() / "scan.json");
  Rig rig({.open_sensor = [](const std::string&) -> std::unique_ptr<DepthSensor> {
    throw Error(ErrorCode::sensor_missing, "none is plugged in");
  }});
  ASSERT_TRUE(
      run_scan(eight_stops(PoseSource::configured), {}, folder.path(), *make_capture(rig), {}, {}));
  EXPECT_TRUE(content_of(folder.path() / "Scan.stl") == model);
  EXPECT_EQ(content_of(folder.path() / "scan.json"), description);
}

TEST(LastLook, CostsNoScanWhereItFails) {
  for (const bool fails : {false, true}) {
    const TemporaryFolder folder;
    FaultyRig faulty(4);
    int looks_at_first = 0;
    faulty.on_frame = [&](int stop) {
      if (stop == 0 && ++looks_at_first > few_snapshots().frames && fails) {
        throw Error(ErrorCode::sensor_lost, "it is gone", "Plug it in again.");
      }
    };
    Rig rig(faulty.options(500));
    const auto model = run_scan(few_snapshots(4), {}, folder.path(), *make_capture(rig), {}, {});
    ASSERT_TRUE(model) << fails;
    EXPECT_EQ(model->report.watertight, true);
    EXPECT_GT(looks_at_first, few_snapshots().frames);
    EXPECT_EQ(read_object_move(folder.path()).has_value(), !fails);
  }
}

TEST(LastLook, IsCutShortWhereTheScanIsCancelled) {
  const TemporaryFolder folder;
  FaultyRig faulty(4);
  Rig rig(faulty.options(500));
  std::stop_source stop;
  const auto cancel = [&](Phase phase, int done) {
    if (phase == Phase::turning && done == 4) {
      stop.request_stop();
    }
  };
  EXPECT_FALSE(run_scan(few_snapshots(4), {}, folder.path(), *make_capture(rig), stop.get_token(),
                        {.on_progress = cancel}));
  EXPECT_EQ(read_scan(folder.path()).shots.size(), 4U);
  EXPECT_FALSE(read_object_move(folder.path()));
  EXPECT_TRUE(run_scan(few_snapshots(4), {}, folder.path(), *make_capture(rig), {}, {}));
}

}  // namespace
}  // namespace octurn
