#include "run/run_scan.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "app/few_snapshots.hpp"
#include "app/wrapped_sensor.hpp"
#include "octurn/scan_folder.hpp"
#include "support/small_disk.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

// Twenty times real time: a stop takes about 50 ms.
constexpr const char* simulator = "octurn-simulator://?speed=20";

RigOptions rig_of(const std::string& uri = simulator) { return {.sensor_uri = uri, .speed = 20}; }

/// The number of images in a scan folder.
int snapshots_in(const fs::path& folder) {
  return static_cast<int>(
      std::distance(fs::directory_iterator(folder / "snapshots"), fs::directory_iterator()));
}

TEST(RunScan, StoresAScanThatGivesTheSameModelLater) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  const auto model = run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), {}, {});
  ASSERT_TRUE(model);
  EXPECT_TRUE(model->report.watertight);
  EXPECT_GT(model->report.triangles, 1000U);

  const Scan scan = read_scan(folder.path());
  const SnapshotSource snapshots{.count = scan.shots.size(), .read = [&](std::size_t shot) {
                                   return read_snapshot(folder.path(), scan, scan.shots[shot]);
                                 }};
  const std::unique_ptr<Reconstructor> again =
      make_reconstructor(reconstruct_options(few_snapshots(), {.threads = 1}));
  again->add(snapshots);
  write_model(*again, snapshots, folder.path() / "again.stl", {});
  EXPECT_TRUE(content_of(folder.path() / "Scan.stl") == content_of(folder.path() / "again.stl"));
}

TEST(RunScan, TellsTheAngleOfEachStopAndTheSettings) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  ASSERT_TRUE(run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), {}, {}));
  const Scan scan = read_scan(folder.path());
  ASSERT_EQ(scan.shots.size(), 3U);
  const double steps = rig.turntable().steps_per_turn();
  for (std::size_t i = 0; i < 3; ++i) {
    // A stop is rounded to a whole microstep, so it may be half a microstep from a third of a turn.
    const double third = 2 * std::numbers::pi / 3 * static_cast<double>(i);
    EXPECT_NEAR(scan.shots[i].angle, third, std::numbers::pi / steps + 1e-9);
    EXPECT_NEAR(std::remainder(scan.shots[i].angle, 2 * std::numbers::pi / steps), 0, 1e-9);
  }
  EXPECT_EQ(scan.clip.max, few_snapshots().clip.max);
  EXPECT_TRUE(scan.platform_from_sensor.isApprox(few_snapshots().platform_from_sensor));
}

TEST(RunScan, TurnsOneWayAndSeesTheSameAgain) {
  const TemporaryFolder first;
  const TemporaryFolder second;
  Rig rig(rig_of("octurn-simulator://?speed=20&noise=0"));
  ASSERT_TRUE(run_scan(few_snapshots(), {}, first.path(), *make_capture(rig), {}, {}));
  const std::int64_t position = rig.turntable().position();
  ASSERT_TRUE(run_scan(few_snapshots(), {}, second.path(), *make_capture(rig), {}, {}));
  EXPECT_EQ(rig.turntable().position(), position + rig.turntable().steps_per_turn());
  EXPECT_TRUE(content_of(first.path() / "Scan.stl") == content_of(second.path() / "Scan.stl"));
}

TEST(RunScan, TakesOneFrameAStopForTheBasicFilter) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  ScanSettings settings = few_snapshots();
  settings.filter = DepthFilter::basic;
  int frames = 0;
  ASSERT_TRUE(run_scan(settings, {}, folder.path(), *make_capture(rig), {},
                       {.on_frame = [&](const DepthFrame&) { ++frames; }}));
  EXPECT_EQ(frames, 4);  // the fourth is the last look, at the first stop again
}

TEST(RunScan, GoesThroughItsPhasesInOrder) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  std::vector<std::pair<Phase, int>> seen;
  ASSERT_TRUE(
      run_scan(few_snapshots(2), {}, folder.path(), *make_capture(rig), {},
               {.on_progress = [&](Phase phase, int done) { seen.emplace_back(phase, done); }}));
  EXPECT_EQ(seen, (std::vector<std::pair<Phase, int>>{{Phase::turning, 0},
                                                      {Phase::capturing, 0},
                                                      {Phase::capturing, 1},
                                                      {Phase::turning, 1},
                                                      {Phase::capturing, 1},
                                                      {Phase::capturing, 2},
                                                      {Phase::turning, 2},
                                                      {Phase::capturing, 2},
                                                      {Phase::calibrating, 2},
                                                      {Phase::building, 2}}));
}

TEST(RunScan, HasASnapshotOnTheDiskBeforeThePlatformMovesOn) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  const auto check = [&](Phase phase, int done) {
    if (phase == Phase::turning && done > 0) {
      const Scan scan = read_scan(folder.path());
      EXPECT_EQ(scan.shots.size(), static_cast<std::size_t>(done));
      read_snapshot(folder.path(), scan, scan.shots.back());
    }
  };
  ASSERT_TRUE(
      run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), {}, {.on_progress = check}));
}

TEST(RunScan, CountsASnapshotThatIsOnTheDiskAlthoughTheOneBeforeItCannotBeAdded) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  int counted = 0;
  const ScanObserver observer{
      .on_progress = [&](Phase, int done) { counted = done; },
      .on_added = [](const Reconstructor&, int) { throw std::runtime_error("cannot be added"); }};
  EXPECT_THROW(run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), {}, observer),
               std::runtime_error);
  EXPECT_EQ(counted, snapshots_in(folder.path()));
}

TEST(RunScan, StopsInAnyPhaseAndKeepsWhatWasStored) {
  for (const auto& moment : {std::pair{Phase::turning, 1},
                             {Phase::capturing, 1},
                             {Phase::turning, 3},
                             {Phase::capturing, 3},
                             {Phase::calibrating, 3},
                             {Phase::building, 3}}) {
    const TemporaryFolder folder;
    Rig rig(rig_of());
    std::stop_source stop;
    const auto stop_in_phase = [&](Phase now, int done) {
      if (std::pair(now, done) == moment) {
        stop.request_stop();
      }
    };
    EXPECT_FALSE(run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), stop.get_token(),
                          {.on_progress = stop_in_phase}))
        << to_string(moment.first);
    EXPECT_EQ(snapshots_in(folder.path()), moment.second) << to_string(moment.first);
    EXPECT_EQ(read_scan(folder.path()).shots.size(), static_cast<std::size_t>(moment.second));
    EXPECT_FALSE(fs::exists(folder.path() / "Scan.stl"));
    // Only scan.json and snapshots/: no partial model is left.
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 2)
        << to_string(moment.first);
  }
}

TEST(RunScan, FailsWhenTheSensorFallsSilentAndKeepsWhatWasStored) {
  const TemporaryFolder folder;
  RigOptions options = rig_of();
  options.open_sensor = [](const std::string& uri) {
    return std::make_unique<SensorSilentOnceTurned>(uri);
  };
  Rig rig(options);
  const Error error = error_thrown_by(
      [&] { run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), {}, {}); });
  EXPECT_EQ(error.code(), ErrorCode::sensor_silent);
  EXPECT_FALSE(error.hint().empty());
  const Scan scan = read_scan(folder.path());
  EXPECT_EQ(scan.shots.size(), 1U);
  EXPECT_EQ(snapshots_in(folder.path()), 1);
}

TEST(RunScan, FailsWhenTheSensorIsUnplugged) {
  const TemporaryFolder folder;
  Rig rig(rig_of("octurn-simulator://?speed=20&lost-after=60"));
  EXPECT_EQ(code_thrown_by([&] {
              run_scan(few_snapshots(200), {}, folder.path(), *make_capture(rig), {}, {});
            }),
            "sensor-lost");
}

TEST(RunScan, LeavesOutASnapshotThatIsDamaged) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  ASSERT_TRUE(run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), {}, {}));
  for (const char* const file : {"snapshots/000.png", "snapshots/002.png"}) {
    put(folder.path() / file, content_of(folder.path() / file).substr(0, 1000));
    fs::remove(folder.path() / "Scan.stl");
    const auto model = run_scan(few_snapshots(), {}, folder.path(), *make_capture(rig), {}, {});
    ASSERT_TRUE(model) << file;
    EXPECT_TRUE(model->report.watertight);
  }
}

TEST(RunScan, FailsWhenTheClipBoxHoldsNothing) {
  const TemporaryFolder folder;
  Rig rig(rig_of());
  ScanSettings settings = few_snapshots();
  settings.clip = {.min = {0.1, 0.1, 0.35}, .max = {0.12, 0.12, 0.39}};
  EXPECT_EQ(
      code_thrown_by([&] { run_scan(settings, {}, folder.path(), *make_capture(rig), {}, {}); }),
      "empty");
}

TEST(RunScan, FailsCleanlyWhenTheDiskIsFull) {
  for (const rlim_t bytes : {10'000U, 400'000U}) {  // less than a snapshot; less than the model
    const TemporaryFolder folder;
    Rig rig(rig_of());
    const SmallDisk disk(bytes);
    ScanSettings settings = few_snapshots();
    settings.method = Method::intersection;  // its model is the larger one
    const Error error =
        error_thrown_by([&] { run_scan(settings, {}, folder.path(), *make_capture(rig), {}, {}); });
    EXPECT_EQ(error.code(), ErrorCode::disk_full) << bytes;
    ASSERT_TRUE(error.parameters().contains("path")) << error.what();
    EXPECT_TRUE(
        std::get<std::string>(error.parameters().at("path")).starts_with(folder.path().string()));
    EXPECT_EQ(fs::exists(folder.path() / "Scan.stl"), false);
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder.path())) {
      EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
    }
  }
}

}  // namespace
}  // namespace octurn
