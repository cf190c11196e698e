// What 400 stops with two lasers take, by a clock of the test's own; and what of it goes on at
// once.

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "app/simulated_laser_rig.hpp"
#include "octurn/scan_folder.hpp"
#include "scan/plan.hpp"
#include "scan/run_scan.hpp"
#include "scan/take_pictures.hpp"
#include "support/patience.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int width = 60;
constexpr int height = 90;
constexpr double period = 1.0 / 15;  // seconds from a picture's begin to that of the next

/// A camera that begins a picture every fifteenth of a second, whatever anybody waits for.
class RunningCamera final : public Camera {
 public:
  /// @param seconds  since the beginning; read and moved on
  /// @param readout  from a picture's begin until it is handed out, seconds
  RunningCamera(double& seconds, double readout, const bool& is_lit)
      : seconds_(seconds), readout_(readout), is_lit_(is_lit) {}

  const std::string& name() const override { return name_; }
  std::string serial() const override { return "15"; }
  Clock::time_point now() const override { return at(seconds_); }

  /// The first picture that is handed out after now, whenever it began.
  std::optional<TimedPicture> read(const std::stop_token&) override {
    constexpr double to_grey = 0.003;  // seconds that a computer has a picture for
    const double begin = period * (std::floor((seconds_ - readout_) / period) + 1);
    seconds_ = begin + readout_ + to_grey;
    TimedPicture timed{.picture = {.width = width, .height = height}, .begin = at(begin)};
    timed.picture.samples.assign(std::size_t{width} * height, is_lit_ ? 200 : 20);
    return timed;
  }

 private:
  static Clock::time_point at(double seconds) {
    return Clock::time_point(std::chrono::duration_cast<Clock::duration>(Seconds(seconds)));
  }

  double& seconds_;
  double readout_;
  const bool& is_lit_;
  std::string name_ = "camera of a test";
};

/// Seconds that 400 stops take.
/// @param disk  of them, at the end of each stop: its last picture's writing, and scan.json's
double time_of_400_stops(double readout, double disk, const Motion& motion) {
  double seconds = 100;  // the camera runs already
  bool is_lit = false;
  LaserSettings told;
  told.lens = {.width = width, .height = height};
  Rig rig({.speed = 1e6, .laser = told, .open_camera = [&](const LaserSettings&) {
             return CameraAndLasers{
                 .camera = std::make_unique<RunningCamera>(seconds, readout, is_lit),
                 .set_line = [&](std::size_t, bool on) { is_lit = on; }};
           }});
  constexpr int stops = 400;
  std::int64_t stands_at = 0;
  const double begin = seconds;
  for (const std::int64_t position : stop_positions(0, motion.steps_per_turn, stops)) {
    const ScanObserver observer{.on_progress = [&](Phase phase, int) {
      if (phase == Phase::capturing) {
        seconds += move_time(motion, position - stands_at) + Seconds(motion.settle_time).count();
      }
    }};
    EXPECT_TRUE(take_pictures(rig, {.position = position}, {}, observer));
    stands_at = position;
    seconds += disk;
  }
  return seconds - begin;
}

// A stop takes eight pictures' time: three are taken, and the platform moves and swings in the
// rest.
TEST(LaserScanTime, IsLessThanFourMinutesFor400StopsAt15PicturesASecond) {
  EXPECT_NEAR(time_of_400_stops(period / 2, 0.02, {}), 400 * 8 * period, 0.5);  // 213 s
  EXPECT_NEAR(time_of_400_stops(period / 2, 0.05, {}), 400 * 8 * period, 0.5);
}

// A picture that is handed out when the next one has begun costs that one, too, as a laser is
// switched in its middle. Nothing but the time that the platform swings can be shorter then.
TEST(LaserScanTime, IsLongerWithACameraThatReadsOutUntilTheNextPictureBegins) {
  EXPECT_NEAR(time_of_400_stops(period, 0.02, {}), 400 * 10 * period, 0.5);  // 267 s
  EXPECT_NEAR(time_of_400_stops(period, 0.02, {.settle_time = std::chrono::milliseconds(150)}),
              400 * 8 * period, 0.5);
}

ScanSettings settings(int stops) {
  ScanSettings few;
  use_laser_capture_defaults(few);
  few.snapshots = stops;
  few.leaf_size = 0.004;
  few.pose = PoseSource::told;
  return few;
}

bool comes(const fs::path& file) {
  const auto deadline = Clock::now() + patience;
  while (!fs::exists(file) && Clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return fs::exists(file);
}

TEST(LaserScanTime, HasEachPictureWrittenWhileTheNextOneIsTaken) {
  const TemporaryFolder folder;
  constexpr int stops = 3;
  SimulatedLaserRig simulated;
  int written = 0;
  simulated.on_picture = [&](SimulatedLaserRig& rig) {
    const std::string stem = "snapshots/00" + std::to_string(rig.pictures / 3);
    constexpr std::array<const char*, 3> before{"", "-dark.png", "-left.png"};
    if (const auto which = static_cast<std::size_t>(rig.pictures % 3); which > 0) {
      written += comes(folder.path() / (stem + before[which])) ? 1 : 0;
    }
  };
  Rig rig(simulated.options(1000));
  ASSERT_TRUE(run_scan(settings(stops), {}, folder.path(), rig, {}, {}));
  EXPECT_EQ(written, 2 * stops);
}

TEST(LaserScanTime, HasAllOfAStopWrittenBeforeThePlatformMovesOn) {
  const TemporaryFolder folder;
  constexpr int stops = 4;
  SimulatedLaserRig simulated;
  Rig rig(simulated.options(1000));
  std::vector<std::size_t> written;  // stops whose pictures are all there, before each move
  const ScanObserver observer{.on_turn = [&](double) {
    written.push_back(0);
    if (written.size() == 1) {
      return;
    }
    for (const Shot& shot : read_scan(folder.path()).shots) {
      for (const std::string& file : shot.pictures) {
        EXPECT_TRUE(fs::exists(folder.path() / file)) << file;
      }
      ++written.back();
    }
  }};
  ASSERT_TRUE(run_scan(settings(stops), {}, folder.path(), rig, {}, observer));
  EXPECT_EQ(written, (std::vector<std::size_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace octurn
