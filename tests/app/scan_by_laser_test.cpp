// Scans with a camera and lasers during which a device fails.

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "app/scanner_fixture.hpp"
#include "app/simulated_laser_rig.hpp"
#include "build/colour_model.hpp"
#include "capture/take_pictures.hpp"
#include "mesh/vertex_table.hpp"
#include "octurn/scan_folder.hpp"
#include "store/stored_scan.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr int laser_stops = 6;
constexpr double laser_speed = 200;

ScanSettings laser_scan_settings() {
  ScanSettings few;
  use_laser_capture_defaults(few);
  few.snapshots = laser_stops;
  few.leaf_size = 0.004;
  few.pose = PoseSource::configured;
  return few;
}

Job ended_job(Scanner& scanner) {
  const Status status = scanner.wait_until_done(patience);
  EXPECT_FALSE(status.busy());
  return *status.job;
}

class ScanByLaser : public ::testing::Test {
 protected:
  /// Calls `action` before picture `number` of the scanner's next scan, counted from 0.
  void before_picture(Scanner& scanner, int number, const std::function<void()>& action) {
    rig_.on_picture([=, &scanner, pictures = 0](SimulatedLaserRig&) mutable {
      if (scanner.status().is_scanning() && pictures++ == number) {
        action();
      }
    });
  }

  TemporaryFolder folder_ = {};
  ScanStore store_{folder_.path()};
  SimulatedLaserRig rig_ = SimulatedLaserRig();
};

TEST_F(ScanByLaser, StoresAFolderThatTheReconstructionReads) {
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  scanner.start(laser_scan_settings());
  const Job job = ended_job(scanner);
  ASSERT_EQ(job.state, JobState::finished) << job.failure->detail;
  EXPECT_TRUE(job.model->report.watertight);
  EXPECT_FALSE(rig_.is_lit());

  const fs::path folder = store_.folder(job.id);
  const Scan scan = read_scan(folder);
  ASSERT_TRUE(scan.laser);
  EXPECT_EQ(scan.sensor_name, "Laser line (simulated)");
  ASSERT_EQ(scan.shots.size(), std::size_t{laser_stops});
  EXPECT_EQ(scan.shots[1].pictures,
            (std::vector<std::string>{"snapshots/001-dark.png", "snapshots/001-left.png",
                                      "snapshots/001-right.png"}));
  EXPECT_NEAR(scan.shots[1].angle, 6.283185307179586 / laser_stops, 0.01);  // one motor step
  const Snapshot snapshot = stored_snapshots(folder, scan).read(0);
  ASSERT_EQ(snapshot.strips.size(), 2U);
  EXPECT_GT(snapshot.strips[0].points.size(), 100U);
}

TEST_F(ScanByLaser, HasThePicturesAndTheModelInColour) {
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  scanner.start(laser_scan_settings());
  const Job job = ended_job(scanner);
  ASSERT_EQ(job.state, JobState::finished) << job.failure->detail;
  EXPECT_TRUE(job.builds.have_colours);
  EXPECT_TRUE(store_.get(job.id).builds.have_colours);
  EXPECT_FALSE(job.builds.have_views);
  EXPECT_FALSE(store_.get(job.id).builds.have_views);
  EXPECT_TRUE(has_colours(store_.folder(job.id), read_scan(store_.folder(job.id))));

  ASSERT_TRUE(scanner.colour_model(job, 0, Colours::pictures));
  const fs::path model = store_.model_file(job.id);
  const std::vector<Rgb> colours = read_colours(model, Colours::pictures);
  EXPECT_EQ(colours.size(), VertexTable(FacetFile(model)).vertices().size());
  EXPECT_EQ(code_thrown_by([&] { scanner.colour_model(job, 0, Colours::views); }), "bad-settings");
}

TEST_F(ScanByLaser, RefusesColoursThatTakeMoreMemoryThanIsAllowed) {
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  scanner.start(laser_scan_settings());
  const Job job = ended_job(scanner);
  const fs::path model = store_.model_file(job.id);
  const auto colour = [&](std::size_t limit) {
    colour_model(model, scan_of_model(store_, job, 0), Colours::pictures, limit, {});
  };

  EXPECT_EQ(code_thrown_by([&] { colour(1 << 20U); }), "memory-limit");
  EXPECT_FALSE(fs::exists(colours_file(model, Colours::pictures)));
  colour(64 << 20U);
  EXPECT_TRUE(fs::exists(colours_file(model, Colours::pictures)));
}

TEST_F(ScanByLaser, EndsColoursWhenItIsStopped) {
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  scanner.start(laser_scan_settings());
  const Job job = ended_job(scanner);
  std::stop_source stop;
  stop.request_stop();
  const fs::path model = store_.model_file(job.id);

  EXPECT_THROW(
      colour_model(model, scan_of_model(store_, job, 0), Colours::pictures, 0, stop.get_token()),
      Stopped);
  EXPECT_FALSE(fs::exists(colours_file(model, Colours::pictures)));
}

TEST_F(ScanByLaser, HasALaserOnForItsOwnPictureAlone) {
  {
    Scanner scanner(rig_.options(laser_speed), {}, store_);
    scanner.start(laser_scan_settings());
    ended_job(scanner);
  }
  const std::string log = rig_.log();
  const std::size_t begin = log.find('A');
  std::string expected;
  for (int time = 0; time < 5; ++time) {
    expected += "Appap";  // shows how late the camera is
  }
  for (int stop = 0; stop < laser_stops; ++stop) {
    expected += std::string(stop == 0 ? "" : "p") + "ApaBpb";
  }
  ASSERT_NE(begin, std::string::npos);
  EXPECT_EQ(log.substr(begin, expected.size()), expected);
  EXPECT_EQ(log.find('A', begin + expected.size()), std::string::npos);
}

TEST_F(ScanByLaser, TakesAStopAgainWhosePictureIsLost) {
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  before_picture(scanner, 27, [this] { rig_.lost_pictures = 1; });
  scanner.start(laser_scan_settings());
  const Job job = ended_job(scanner);
  ASSERT_EQ(job.state, JobState::finished) << job.failure->detail;
  EXPECT_EQ(read_scan(store_.folder(job.id)).shots.size(), std::size_t{laser_stops});
}

TEST_F(ScanByLaser, PausesWithoutItsCameraAndGoesOnAtTheSameStop) {
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  before_picture(scanner, 30, [this] { rig_.is_unplugged = true; });
  scanner.start(laser_scan_settings());
  const Job paused = ended_job(scanner);
  ASSERT_EQ(paused.state, JobState::paused);
  EXPECT_EQ(paused.failure->code, ErrorCode::sensor_missing);
  EXPECT_FALSE(rig_.is_lit());
  EXPECT_GT(paused.snapshots_done, 0);
  EXPECT_LT(paused.snapshots_done, laser_stops);
  EXPECT_EQ(read_scan(store_.folder(paused.id)).shots.size(),
            static_cast<std::size_t>(paused.snapshots_done));
  rig_.is_unplugged = false;
  ASSERT_TRUE(scanner.resume(paused.id));
  EXPECT_EQ(ended_job(scanner).state, JobState::finished);
}

TEST_F(ScanByLaser, PausesWithTheNameOfALaserThatGivesNoLight) {
  rig_.dark_laser = 0;
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  scanner.start(laser_scan_settings());
  const Job paused = ended_job(scanner);
  ASSERT_EQ(paused.state, JobState::paused);
  EXPECT_EQ(paused.failure->code, ErrorCode::sensor_blind);
  EXPECT_NE(paused.failure->detail.find("laser left"), std::string::npos) << paused.failure->detail;
  EXPECT_FALSE(rig_.is_lit());
  EXPECT_EQ(paused.snapshots_done, 0);
}

TEST_F(ScanByLaser, EndsWithItsLasersOffWhenItIsCancelled) {
  Scanner scanner(rig_.options(laser_speed), {}, store_);
  before_picture(scanner, 5, [&] { scanner.cancel(scanner.status().job->id); });
  scanner.start(laser_scan_settings());
  EXPECT_EQ(ended_job(scanner).state, JobState::cancelled);
  EXPECT_FALSE(rig_.is_lit());
}

/// The pictures of a stop to which the platform has turned from another one.
std::vector<Picture> pictures_at(SimulatedLaserRig& simulated) {
  Rig rig(simulated.options(laser_speed));
  EXPECT_TRUE(take_pictures(rig, {.position = 100}, {}, {}));
  return take_pictures(rig, {.index = 1, .position = 300}, {}, {})->pictures;
}

/// The number of pixels that differ by more than noise and a lamp's flicker.
int difference(const Picture& one, const Picture& other) {
  constexpr int noise = 25;  // grey levels
  int pixels = 0;
  for (std::size_t i = 0; i < one.samples.size(); ++i) {
    const int change = static_cast<int>(one.samples[i]) - static_cast<int>(other.samples[i]);
    pixels += std::abs(change) > noise ? 1 : 0;
  }
  return pixels;
}

TEST_F(ScanByLaser, HasTheSamePicturesHoweverLateTheCameraIs) {
  const std::vector<Picture> in_time = pictures_at(rig_);
  constexpr int of_a_line = 50;  // pixels
  EXPECT_GT(difference(in_time[0], in_time[1]), of_a_line);
  EXPECT_GT(difference(in_time[1], in_time[2]), of_a_line);
  for (int late = 1; late <= 4; ++late) {
    SimulatedLaserRig simulated;
    simulated.late = late;
    const std::vector<Picture> pictures = pictures_at(simulated);
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT(difference(pictures[i], in_time[i]), of_a_line / 5) << late << ", picture " << i;
    }
  }
  SimulatedLaserRig simulated;
  simulated.late = 5;
  EXPECT_EQ(code_thrown_by([&] { pictures_at(simulated); }), "sensor-failed");
}

}  // namespace
}  // namespace octurn
