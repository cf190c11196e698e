// Scans whose hardware fails, at each stop in turn.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/faulty_rig.hpp"
#include "app/scanner_fixture.hpp"
#include "octurn/scan_folder.hpp"
#include "run/scanner.hpp"
#include "store/job_file.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr int fault_stops = 4;
constexpr std::chrono::hours forever(1'000'000);  // also at that speed
constexpr double fault_speed = 500;  // a failing stop is retried for 60 ms in place of 30 s

ScanSettings fault_settings(Method method = Method::solid) {
  return {.snapshots = fault_stops, .frames = 2, .method = method, .leaf_size = 0.004};
}

Job ended(const Scanner& scanner) {
  const Status status = scanner.wait_until_done(patience);
  EXPECT_FALSE(status.busy());
  return *status.job;
}

/// The model of a scan without faults.
std::string undisturbed_model(Method method = Method::solid) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  FaultyRig rig(fault_stops);
  Scanner scanner(rig.options(fault_speed), {}, store);
  scanner.start(fault_settings(method));
  const Job job = ended(scanner);
  EXPECT_EQ(job.state, JobState::finished);
  return content_of(store.model_file(job.id));
}

int stored_snapshots(const ScanStore& store, const Job& job) {
  if (job.snapshots_done == 0) {
    return 0;
  }
  const Scan scan = read_scan(store.folder(job.id));
  for (const Shot& shot : scan.shots) {
    read_snapshot(store.folder(job.id), scan, shot);
  }
  return static_cast<int>(scan.shots.size());
}

struct Case {
  Fault fault;
  int first_stop;  // the first stop at which it can be detected
  std::string code;
};

std::ostream& operator<<(std::ostream& out, const Case& fault) { return out << fault.code; }

class ScanFaults : public ::testing::TestWithParam<Case> {};

TEST_P(ScanFaults, PauseAScanAtAnyStopAndItGoesOnFromThere) {
  const Case& fault = GetParam();
  const std::string model = undisturbed_model();
  for (int stop = fault.first_stop; stop < fault_stops; ++stop) {
    SCOPED_TRACE(stop);
    const TemporaryFolder folder;
    ScanStore store(folder.path());
    FaultyRig rig(fault_stops);
    Scanner scanner(rig.options(fault_speed), {}, store);
    rig.fail(fault.fault, stop);
    scanner.start(fault_settings());
    const Job paused = ended(scanner);
    ASSERT_EQ(paused.state, JobState::paused);
    EXPECT_EQ(to_string(paused.failure->code), fault.code);
    EXPECT_NE(paused.failure->hint.find("resume"), std::string::npos) << paused.failure->hint;
    EXPECT_EQ(paused.snapshots_done, stop);
    EXPECT_EQ(stored_snapshots(store, paused), stop);
    EXPECT_EQ(to_job_json(*store.find(paused.id)), to_job_json(paused));
    EXPECT_FALSE(rig.is_motor_on());

    rig.mend();
    EXPECT_EQ(scanner.resume(paused.id)->state, JobState::running);
    const Job done = ended(scanner);
    ASSERT_EQ(done.state, JobState::finished) << (done.failure ? done.failure->detail : "");
    EXPECT_FALSE(done.failure);
    EXPECT_EQ(done.snapshots_done, fault_stops);
    EXPECT_TRUE(content_of(store.model_file(done.id)) == model);
    EXPECT_FALSE(rig.is_motor_on());
  }
}

TEST_P(ScanFaults, ThatPassDoNotEvenPauseAScan) {
  const std::string model = undisturbed_model();
  for (int stop = GetParam().first_stop; stop < fault_stops; ++stop) {
    SCOPED_TRACE(stop);
    const TemporaryFolder folder;
    ScanStore store(folder.path());
    FaultyRig rig(fault_stops);
    Scanner scanner(rig.options(fault_speed, {.time = forever}), {}, store);
    rig.fail(GetParam().fault, stop);
    scanner.start(fault_settings());
    const Status failing = wait_until(
        scanner, [](const Status& status) { return !status.busy() || status.job->failure; });
    EXPECT_TRUE(failing.busy());
    rig.mend();
    const Job done = ended(scanner);
    ASSERT_EQ(done.state, JobState::finished) << done.failure->detail;
    EXPECT_FALSE(done.failure);
    EXPECT_TRUE(content_of(store.model_file(done.id)) == model);
    EXPECT_EQ(rig.moves_without_motor(), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Each, ScanFaults,
                         ::testing::Values(Case{Fault::silent, 0, "sensor-silent"},
                                           Case{Fault::unplugged, 0, "sensor-missing"},
                                           Case{Fault::half_blind, 1, "sensor-blind"},
                                           Case{Fault::line_refused, 0, "turntable-failed"}));

class PausedScan : public ::testing::Test {
 protected:
  /// A scan that is paused at stop 2.
  Job pause() {
    rig_.fail(Fault::unplugged, 2);
    scanner_.start(fault_settings());
    const Job job = ended(scanner_);
    EXPECT_EQ(job.state, JobState::paused);
    return job;
  }

  TemporaryFolder folder_ = {};
  ScanStore store_{folder_.path()};
  FaultyRig rig_{fault_stops};
  Scanner scanner_{rig_.options(fault_speed), {}, store_};
};

TEST_F(PausedScan, PausesAgainIfNothingWasMended) {
  const Job job = pause();
  ASSERT_TRUE(scanner_.resume(job.id));
  EXPECT_EQ(ended(scanner_).state, JobState::paused);
  EXPECT_EQ(stored_snapshots(store_, *store_.find(job.id)), 2);
}

TEST_F(PausedScan, IsEndedByACancelAndKeepsItsSnapshots) {
  const Job job = pause();
  EXPECT_TRUE(scanner_.cancel(job.id));
  EXPECT_EQ(scanner_.status().job->state, JobState::cancelled);
  const Job stored = *store_.find(job.id);
  EXPECT_EQ(stored.state, JobState::cancelled);
  EXPECT_FALSE(stored.failure);
  EXPECT_EQ(stored_snapshots(store_, stored), 2);
  EXPECT_FALSE(scanner_.cancel(job.id));
}

TEST_F(PausedScan, GoesOnWithItsOwnSensorOnly) {
  const Job job = pause();
  rig_.mend();
  rig_.set_lens({.fx = 580});
  ASSERT_TRUE(scanner_.resume(job.id));
  const Job other = ended(scanner_);
  EXPECT_EQ(other.state, JobState::paused);
  EXPECT_EQ(other.failure->code, ErrorCode::sensor_other);
  EXPECT_EQ(other.failure->parameters,
            (Parameters{{"begun_with", read_scan(store_.folder(job.id)).sensor_name}}));
  rig_.set_lens({});
  ASSERT_TRUE(scanner_.resume(job.id));
  EXPECT_EQ(ended(scanner_).state, JobState::finished);
}

TEST_F(PausedScan, CountsTheLatePulsesOfAllItsParts) {
  rig_.set_pulse_delay(2ms);
  const Job job = pause();
  const int late = job.times.late_pulses;
  EXPECT_GT(late, FaultyRig::steps / 2 - 10);  // half a turn, to stop 2 of 4
  rig_.mend();
  ASSERT_TRUE(scanner_.resume(job.id));
  const Job done = ended(scanner_);
  EXPECT_GT(done.times.late_pulses, late + FaultyRig::steps / 4 - 10);
  EXPECT_EQ(store_.find(job.id)->times.late_pulses, done.times.late_pulses);
}

TEST_F(PausedScan, LetsAnotherScanBeMadeMeanwhile) {
  const Job job = pause();
  rig_.mend();
  rig_.hold();
  const auto other = scanner_.start(fault_settings());
  EXPECT_FALSE(scanner_.resume(job.id));  // as the other scan runs
  rig_.let_go();
  ASSERT_TRUE(other);
  EXPECT_EQ(ended(scanner_).state, JobState::finished);
  ASSERT_TRUE(scanner_.resume(job.id));
  EXPECT_EQ(ended(scanner_).state, JobState::finished);
  EXPECT_TRUE(content_of(store_.model_file(job.id)) == content_of(store_.model_file(other->id)));
}

TEST_F(PausedScan, IsStillPausedForTheNextRunOfTheProgram) {
  const Job job = pause();
  const TemporaryFolder folder;
  fs::copy(folder_.path(), folder.path(), fs::copy_options::recursive);
  ScanStore store(folder.path());
  FaultyRig rig(fault_stops, rig_.position());
  Scanner scanner(rig.options(fault_speed), {}, store);
  EXPECT_EQ(store.find(job.id)->state, JobState::paused);
  ASSERT_TRUE(scanner.resume(job.id));
  EXPECT_EQ(ended(scanner).state, JobState::finished);
  EXPECT_TRUE(content_of(store.model_file(job.id)) == undisturbed_model());
}

TEST(ScanThatTriesAgain, TellsWhatItWaitsForAndCanBeCancelled) {
  const TemporaryFolder folder;
  ScanStore store(folder.path());
  FaultyRig rig(fault_stops);
  rig.fail(Fault::silent, 1);
  Scanner patient(rig.options(fault_speed, {.time = forever, .interval = forever}), {}, store);
  patient.start(fault_settings());
  const Status status =
      wait_until(patient, [](const Status& now) { return !now.busy() || now.job->failure; });
  EXPECT_EQ(status.job->state, JobState::running);
  EXPECT_EQ(status.job->failure->code, ErrorCode::sensor_silent);
  EXPECT_TRUE(patient.cancel(status.job->id));  // while it waits to try again
  EXPECT_EQ(ended(patient).state, JobState::cancelled);
  EXPECT_FALSE(rig.is_motor_on());
}

TEST(CancelledScan, EndsAtAnyStopAndKeepsItsSnapshots) {
  for (int stop = 0; stop < fault_stops; ++stop) {
    SCOPED_TRACE(stop);
    const TemporaryFolder folder;
    ScanStore store(folder.path());
    FaultyRig rig(fault_stops);
    std::atomic<Scanner*> scanning = nullptr;
    rig.on_frame = [&](int now) {
      Scanner* const scanner = scanning;
      const Status status = scanner == nullptr ? Status{} : scanner->status();
      if (status.busy() && now == stop) {
        scanner->cancel(status.job->id);
      }
    };
    Scanner scanner(rig.options(fault_speed), {}, store);
    scanning = &scanner;
    scanner.start(fault_settings());
    const Job job = ended(scanner);
    EXPECT_EQ(job.state, JobState::cancelled);
    EXPECT_EQ(job.snapshots_done, stop);
    EXPECT_EQ(stored_snapshots(store, job), stop);
    EXPECT_FALSE(rig.is_motor_on());
    EXPECT_TRUE(scanner.can_resume(job));
  }
}

class KilledScan : public ::testing::TestWithParam<Method> {};

// A copy of the folder taken at a stop is what a kill or a power cut would leave.
TEST_P(KilledScan, GoesOnFromAnyStop) {
  const std::string model = undisturbed_model(GetParam());
  std::array<TemporaryFolder, fault_stops> left;
  std::array<std::int64_t, fault_stops> left_at = {};
  {
    const TemporaryFolder folder;
    ScanStore store(folder.path());
    FaultyRig rig(fault_stops);
    std::array<bool, fault_stops> copied = {};
    rig.on_frame = [&](int stop) {
      const auto at = static_cast<std::size_t>(stop);
      if (!store.list().empty() && !std::exchange(copied[at], true)) {
        fs::copy(folder.path(), left[at].path(), fs::copy_options::recursive);
        left_at[at] = rig.position();
      }
    };
    Scanner scanner(rig.options(fault_speed), {}, store);
    scanner.start(fault_settings(GetParam()));
    ASSERT_EQ(ended(scanner).state, JobState::finished);
  }
  for (std::size_t stop = 0; stop < fault_stops; ++stop) {
    SCOPED_TRACE(stop);
    ScanStore store(left[stop].path());
    const Job interrupted = store.list().at(0);
    EXPECT_EQ(interrupted.state, JobState::interrupted);
    EXPECT_EQ(interrupted.snapshots_done, static_cast<int>(stop));
    FaultyRig rig(fault_stops, left_at[stop]);
    Scanner scanner(rig.options(fault_speed), {}, store);
    ASSERT_TRUE(scanner.resume(interrupted.id));
    const Job done = ended(scanner);
    ASSERT_EQ(done.state, JobState::finished) << done.failure->detail;
    EXPECT_TRUE(content_of(store.model_file(done.id)) == model);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, KilledScan, ::testing::Values(Method::solid, Method::intersection));

}  // namespace
}  // namespace octurn
