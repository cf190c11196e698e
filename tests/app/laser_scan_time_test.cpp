// The duration of 400 stops with two lasers, by a simulated clock, and what runs concurrently.

#include <gtest/gtest.h>

#include <algorithm>
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
#include "capture/plan.hpp"
#include "capture/take_pictures.hpp"
#include "config.hpp"
#include "octurn/scan_folder.hpp"
#include "run/run_scan.hpp"
#include "support/patience.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int width = 60;
constexpr int height = 90;
constexpr double period = 1.0 / 15;  // seconds between the starts of successive pictures

/// The simulated clock and the rig's state.
struct Course {
  double seconds = 100;  // now; the camera already runs
  double stood_at = 0;   // end of the platform's last move, after which it still oscillates
  std::optional<double> lit_at = {};
  double shortest_rest = 1;  // seconds between a move's end and the first exposure with a laser
};

/// A free-running camera that starts a picture every fifteenth of a second.
class RunningCamera final : public Camera {
 public:
  /// @param readout  seconds from a picture's start until it is delivered
  RunningCamera(Course& course, double readout) : course_(course), readout_(readout) {}

  const std::string& name() const override { return name_; }
  std::string serial() const override { return "15"; }
  Clock::time_point now() const override { return at(course_.seconds); }

  /// The next picture to be delivered, which may have started before now.
  std::optional<TimedPicture> read(const std::stop_token&) override {
    constexpr double to_grey = 0.003;  // seconds for the conversion to grey
    const double begin = period * (std::floor((course_.seconds - readout_) / period) + 1);
    course_.seconds = begin + readout_ + to_grey;
    const auto& lit_at = course_.lit_at;
    if (lit_at && begin >= *lit_at) {
      course_.shortest_rest = std::min(course_.shortest_rest, begin - course_.stood_at);
    }
    TimedPicture timed{.picture = {.width = width, .height = height}, .begin = at(begin)};
    timed.picture.samples.assign(std::size_t{width} * height, 20);
    for (std::size_t row = 0; lit_at && row < height; ++row) {
      timed.picture.samples[row * width + width / 2] = 200;
    }
    return timed;
  }

 private:
  static Clock::time_point at(double seconds) {
    return Clock::time_point(std::chrono::duration_cast<Clock::duration>(Seconds(seconds)));
  }

  Course& course_;
  double readout_;
  std::string name_ = "camera of a test";
};

struct Timing {
  double seconds = 0;        // duration of 400 stops
  double shortest_rest = 0;  // as in `Course`
};

/// Takes the pictures of 400 stops.
/// @param disk  seconds at the end of each stop to write its last picture and scan.json
Timing time_400_stops(double readout, double disk, const Motion& motion) {
  Course course;
  LaserSettings told;
  told.lens = {.width = width, .height = height};
  Rig rig({.speed = 1e6, .laser = told, .open_camera = [&](const LaserSettings&) {
             return CameraAndLasers{.camera = std::make_unique<RunningCamera>(course, readout),
                                    .set_line = [&](std::size_t, bool on) {
                                      course.lit_at =
                                          on ? std::optional(course.seconds) : std::nullopt;
                                    }};
           }});
  rig.lasers().late_pictures = 0;
  constexpr int stops = 400;
  std::int64_t stands_at = 0;
  const double begin = course.seconds;
  for (const std::int64_t position : stop_positions(0, motion.steps_per_turn, stops)) {
    const ScanObserver observer{.on_progress = [&](Phase phase, int) {
      if (phase == Phase::capturing) {
        course.stood_at = course.seconds + move_time(motion, position - stands_at);
        course.seconds = course.stood_at + Seconds(motion.settle_time).count();
      }
    }};
    EXPECT_TRUE(take_pictures(rig, {.position = position}, {}, observer));
    stands_at = position;
    course.seconds += disk;
  }
  return {.seconds = course.seconds - begin, .shortest_rest = course.shortest_rest};
}

/// The default motion of a turntable with lasers.
Motion laser_motion() { return to_motion(chosen_config({}, SensorKind::laser_line).turntable); }

// A stop takes six picture periods: three for pictures, three for the platform to move and settle;
// a slow disk takes one more.
TEST(LaserScanTime, IsLessThanThreeMinutesFor400StopsAt15PicturesASecond) {
  const double expected = 400 * 6 * period;  // 160 s
  EXPECT_NEAR(time_400_stops(period / 2, 0.01, laser_motion()).seconds, expected, 0.5);
  EXPECT_NEAR(time_400_stops(period / 2, 0.05, laser_motion()).seconds, 400 * 7 * period, 0.5);
}

// Here each laser is switched in the middle of a picture, which must be discarded.
TEST(LaserScanTime, IsFourMinutesWithACameraThatReadsOutUntilTheNextPictureBegins) {
  const double expected = 400 * 9 * period;  // 240 s
  EXPECT_NEAR(time_400_stops(period, 0.02, laser_motion()).seconds, expected, 0.5);
}

// The dark picture comes first and takes at least one period.
TEST(LaserScanTime, LeavesThePlatform217MsToSettleBeforeALineIsExposed) {
  const double settled = Seconds(laser_settle_time).count() + period;
  EXPECT_GE(time_400_stops(period / 2, 0.02, laser_motion()).shortest_rest, settled - 1e-6);
  EXPECT_GE(time_400_stops(period, 0.02, laser_motion()).shortest_rest, settled + period - 1e-6);
}

ScanSettings timed_settings(int stops) {
  ScanSettings few;
  use_laser_capture_defaults(few);
  few.snapshots = stops;
  few.leaf_size = 0.004;
  few.pose = PoseSource::configured;
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
  simulated.on_picture([&](SimulatedLaserRig& rig) {
    const std::string stem = "snapshots/00" + std::to_string(rig.pictures / 3);
    constexpr std::array<const char*, 3> before{"", "-dark.png", "-left.png"};
    if (const auto which = static_cast<std::size_t>(rig.pictures % 3); which > 0) {
      written += comes(folder.path() / (stem + before[which])) ? 1 : 0;
    }
  });
  Rig rig(simulated.options(1000));
  rig.lasers().late_pictures = 0;
  ASSERT_TRUE(run_scan(timed_settings(stops), {}, folder.path(), *make_capture(rig), {}, {}));
  EXPECT_EQ(written, 2 * stops);
}

TEST(LaserScanTime, HasAllOfAStopWrittenBeforeThePlatformMovesOn) {
  const TemporaryFolder folder;
  constexpr int stops = 4;
  SimulatedLaserRig simulated;
  Rig rig(simulated.options(1000));
  std::vector<std::size_t> written;  // stops with all their pictures, before each move
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
  ASSERT_TRUE(run_scan(timed_settings(stops), {}, folder.path(), *make_capture(rig), {}, observer));
  EXPECT_EQ(written, (std::vector<std::size_t>{0, 1, 2, 3}));
}

}  // namespace
}  // namespace octurn
