#include <gtest/gtest.h>

#include "app/scanner_fixture.hpp"
#include "octurn/scan_folder.hpp"
#include "support/thrown_error.hpp"

namespace octurn {
namespace {

using namespace std::chrono_literals;

TEST_F(ScannerTest, TellsWhatItHasBeforeAnyScan) {
  const Scanner scanner(rig(), {}, store_);
  const Status status = wait_until(scanner, is_ready);
  EXPECT_TRUE(is_ready(status));
  EXPECT_NE(status.sensor.name.find("Kinect"), std::string::npos);
  EXPECT_TRUE(status.sensor.simulated);
  EXPECT_EQ(status.turntable.state, DeviceStatus::State::ready);
  EXPECT_FALSE(status.job);
}

TEST_F(ScannerTest, ScansToTheEnd) {
  Scanner scanner(rig(), {}, store_);
  const Job job = scan(scanner, few_snapshots());
  EXPECT_EQ(job.state, JobState::finished);
  EXPECT_EQ(job.phase, Phase::done);
  EXPECT_EQ(job.snapshots_done, 3);
  ASSERT_TRUE(job.model);
  EXPECT_TRUE(job.model->report.watertight);
  EXPECT_EQ(std::filesystem::file_size(store_.model_file(job.id)), job.model->report.bytes);
  const auto stored = store_.find(job.id);
  EXPECT_EQ(stored->state, JobState::finished);
  EXPECT_EQ(stored->model->report.triangles, job.model->report.triangles);
}

TEST_F(ScannerTest, RefusesASecondStartAndTakesTheNextOneAfterwards) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 0);
  ASSERT_TRUE(scanner.start(few_snapshots()));
  EXPECT_FALSE(scanner.start(few_snapshots()));
  EXPECT_EQ(store_.list().size(), 1U);
  gate_.let_go();
  scanner.wait_until_done(patience);
  EXPECT_EQ(scan(scanner, few_snapshots()).state, JobState::finished);
}

TEST_F(ScannerTest, CancelsAScanAndDoesTheNextOne) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 2);
  const auto job = scanner.start(few_snapshots());
  EXPECT_FALSE(scanner.cancel("20261121-081500-0000"));
  wait_for_snapshots(scanner, 2);
  EXPECT_TRUE(scanner.cancel(job->id));
  const Status status = scanner.wait_until_done(patience);
  EXPECT_EQ(status.job->snapshots_done, 2);
  EXPECT_EQ(status.job->state, JobState::cancelled);
  EXPECT_EQ(store_.find(job->id)->state, JobState::cancelled);
  EXPECT_EQ(read_scan(store_.folder(job->id)).shots.size(), 2U);
  EXPECT_FALSE(scanner.cancel(job->id));
  gate_.let_go();
  EXPECT_EQ(scan(scanner, few_snapshots()).state, JobState::finished);
  EXPECT_EQ(code_thrown_by([&] { scanner.resume(job->id); }), "not-paused")
      << "its object has gone since";
}

TEST_F(ScannerTest, PausesAScanAndGoesOnWithTheTimeThatItHasTaken) {
  std::string id;
  std::chrono::duration<double> elapsed = {};
  {
    Scanner scanner(gate_.before(rig()), {}, store_);
    gate_.hold(scanner, 2);
    id = scanner.start(few_snapshots(6))->id;
    EXPECT_FALSE(scanner.pause("20261121-081500-0000"));
    wait_for_snapshots(scanner, 2);
    EXPECT_TRUE(scanner.pause(id));
    const Job paused = *scanner.wait_until_done(patience).job;
    EXPECT_EQ(paused.state, JobState::paused);
    EXPECT_FALSE(paused.failure);
    EXPECT_FALSE(scanner.pause(id));
    elapsed = paused.times.elapsed;
  }
  Scanner scanner(rig(), {}, store_);  // another run of the program
  ASSERT_TRUE(scanner.resume(id));
  const Job done = *scanner.wait_until_done(patience).job;
  EXPECT_EQ(done.state, JobState::finished);
  EXPECT_EQ(done.snapshots_done, 6);
  EXPECT_GT(done.times.elapsed, elapsed);
}

TEST_F(ScannerTest, GoesOnWithTheLastScanThatWasEnded) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 2);
  const std::string id = scanner.start(few_snapshots(6))->id;
  wait_for_snapshots(scanner, 2);
  scanner.cancel(id);
  ASSERT_EQ(scanner.wait_until_done(patience).job->state, JobState::cancelled);
  gate_.let_go();
  ASSERT_TRUE(scanner.can_resume(scanner.find(id)));
  ASSERT_TRUE(scanner.resume(id));
  const Job done = *scanner.wait_until_done(patience).job;
  EXPECT_EQ(done.state, JobState::finished);
  EXPECT_EQ(done.snapshots_done, 6);
}

TEST_F(ScannerTest, KeepsTheTimeOfAScanThatIsCutOff) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 2);
  const std::string id = scanner.start(few_snapshots())->id;
  wait_for_snapshots(scanner, 2);  // that of the first is saved by then
  EXPECT_GT(store_.get(id).times.elapsed.count(), 0) << "as a power cut would find it";
}

TEST_F(ScannerTest, RemovesNoScanThatRuns) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 1);
  const auto job = scanner.start(few_snapshots());
  EXPECT_EQ(code_thrown_by([&] { scanner.remove(job->id); }), "busy");
  wait_for_snapshots(scanner, 1);
  scanner.cancel(job->id);
  scanner.wait_until_done(patience);
  scanner.remove(job->id);
  EXPECT_EQ(code_thrown_by([&] { scanner.resume(job->id); }), "no-such-scan");
  EXPECT_EQ(code_thrown_by([&] { scanner.remove(job->id); }), "no-such-scan");
}

TEST_F(ScannerTest, ShowsTheNameOfAScanThatRuns) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 2);
  const auto job = scanner.start(few_snapshots());
  scanner.label(job->id, {.name = "Hase", .notes = "of clay"});
  EXPECT_EQ(scanner.status().job->label.name, "Hase");
  wait_for_snapshots(scanner, 2);
  EXPECT_EQ(scanner.status().job->label.name, "Hase");
  EXPECT_EQ(scanner.find(job->id).label.name, "Hase");
  EXPECT_EQ(scanner.list().at(0).label.name, "Hase");
  EXPECT_EQ(scanner.status().job->label.notes, "of clay");
}

TEST_F(ScannerTest, FinishesNoScanWhoseFolderIsRemovedMeanwhile) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 2);
  const auto job = scanner.start(few_snapshots());
  wait_for_snapshots(scanner, 2);
  const TemporaryFolder elsewhere;  // at once: the scan may be saved while a folder is emptied
  std::filesystem::rename(store_.folder(job->id), elsewhere.path() / "scan");
  gate_.let_go();
  const Job ended = *scanner.wait_until_done(patience).job;
  EXPECT_EQ(ended.state, JobState::interrupted);
  ASSERT_TRUE(ended.failure);
  EXPECT_EQ(ended.failure->code, ErrorCode::write_failed) << ended.failure->detail;
  EXPECT_FALSE(std::filesystem::exists(store_.folder(job->id)));
}

/// Replaces a file by a folder, which no file can replace. The running scan may save the file again
/// between the two steps.
void bar_from_being_saved(const std::filesystem::path& file) {
  std::error_code saved_again;
  do {
    std::filesystem::remove(file);
  } while (!std::filesystem::create_directory(file, saved_again));
}

TEST_F(ScannerTest, CallsAScanInterruptedWhoseEndCannotBeSavedAndResumesIt) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 2);
  const auto job = scanner.start(few_snapshots());
  wait_for_snapshots(scanner, 2);
  const std::filesystem::path record = store_.folder(job->id) / "job.json";
  bar_from_being_saved(record);
  EXPECT_TRUE(scanner.cancel(job->id));
  const Job shown = *scanner.wait_until_done(patience).job;
  EXPECT_EQ(shown.state, JobState::interrupted);
  EXPECT_EQ(shown.failure->code, ErrorCode::write_failed);  // and not that it was switched off
  EXPECT_EQ(scanner.find(job->id).state, JobState::interrupted);
  EXPECT_EQ(shown.snapshots_done, static_cast<int>(read_scan(store_.folder(job->id)).shots.size()));
  EXPECT_EQ(code_thrown_by([&] { scanner.resume(job->id); }), "write-failed");
  std::filesystem::remove(record);
  gate_.let_go();
  ASSERT_TRUE(scanner.resume(job->id));
  EXPECT_EQ(scanner.wait_until_done(patience).job->state, JobState::finished);
}

TEST_F(ScannerTest, CancelsAScanWhoseEndCouldNotBeSaved) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  gate_.hold(scanner, 1);
  const auto job = scanner.start(few_snapshots());
  wait_for_snapshots(scanner, 1);
  const std::filesystem::path record = store_.folder(job->id) / "job.json";
  bar_from_being_saved(record);
  scanner.cancel(job->id);
  scanner.wait_until_done(patience);
  std::filesystem::remove(record);
  EXPECT_TRUE(scanner.cancel(job->id));
  EXPECT_EQ(scanner.find(job->id).state, JobState::cancelled);
}

/// A stream of a finished scan's model, finer than the stored one and larger than a pipe's buffer.
std::unique_ptr<ModelStream> stream_of(Scanner& scanner, const Job& job) {
  ReconstructOptions options = reconstruct_options(job.settings, {});
  options.method = Method::intersection;
  options.leaf_size = 0.001;
  return scanner.stream_model(job.id, options);
}

/// Such a stream, once the previous one is abandoned.
std::unique_ptr<ModelStream> next_stream_of(Scanner& scanner, const Job& job) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::unique_ptr<ModelStream> next;
  while (!next && std::chrono::steady_clock::now() < deadline) {
    next = stream_of(scanner, job);
  }
  return next;
}

TEST_F(ScannerTest, StreamsAModelOfAStoredScan) {
  Scanner scanner(rig(), {}, store_);
  const Job job = scan(scanner, few_snapshots());
  const auto model = stream_of(scanner, job);
  ASSERT_TRUE(model);
  EXPECT_FALSE(stream_of(scanner, job));  // one at a time
  std::uint64_t sent = 0;
  model->send([&](std::span<const std::byte> bytes) {
    sent += bytes.size();
    return true;
  });
  EXPECT_EQ(sent, model->bytes());
  EXPECT_GT(sent, job.model->report.bytes);
}

TEST_F(ScannerTest, StartsAScanWhileNobodyTakesAModel) {
  Scanner scanner(rig(), {}, store_);
  const Job job = scan(scanner, few_snapshots());
  const auto model = stream_of(scanner, job);
  ASSERT_TRUE(model);
  ASSERT_GT(model->bytes(), 2 * ModelPipe::max_bytes);
  EXPECT_EQ(scan(scanner, few_snapshots()).state, JobState::finished);
  EXPECT_TRUE(model->stop().stop_requested());
  std::uint64_t sent = 0;
  model->send([&](std::span<const std::byte> bytes) {
    sent += bytes.size();
    return true;
  });
  EXPECT_LT(sent, model->bytes());
}

TEST_F(ScannerTest, GivesAModelUpThatNobodyWants) {
  Scanner scanner(rig(), {}, store_);
  const Job job = scan(scanner, few_snapshots());
  stream_of(scanner, job).reset();
  EXPECT_TRUE(next_stream_of(scanner, job));
}

TEST_F(ScannerTest, SaysWhyAModelCannotBeMade) {
  Scanner scanner(rig(), {}, store_);
  const Job job = scan(scanner, few_snapshots());
  ReconstructOptions options = reconstruct_options(job.settings, {});
  options.memory_limit = 1000;
  EXPECT_EQ(code_thrown_by([&] { scanner.stream_model(job.id, options); }), "memory-limit");
  EXPECT_TRUE(next_stream_of(scanner, job));
}

TEST(Heartbeat, IsAliveForAsLongAsItMayBeSilent) {
  Heartbeat heartbeat;
  EXPECT_TRUE(heartbeat.is_alive(1h));
  EXPECT_FALSE(heartbeat.is_alive(-1ns));
  heartbeat.suspend();
  EXPECT_TRUE(heartbeat.is_alive(-1ns));
  heartbeat.beat();
  EXPECT_FALSE(heartbeat.is_alive(-1ns));
}

// The countdown is tested in TimeLeft, as it depends on the machine's speed here.
TEST_F(ScannerTest, TellsWhatIsLeftOnceThereIsSomethingToTellItFrom) {
  Scanner scanner(gate_.before(rig()), {}, store_);
  const auto has_time_left = [](const Status& s) { return s.job->times.left.has_value(); };
  gate_.hold(scanner, 0);
  ASSERT_TRUE(scanner.start(few_snapshots(8)));
  EXPECT_FALSE(has_time_left(scanner.status()));
  gate_.hold(scanner, 4);
  const Status early = wait_until(scanner, has_time_left);
  ASSERT_TRUE(early.job->times.left);
  EXPECT_GT(early.job->snapshots_done, 0);
  EXPECT_GE(*early.job->times.left, 0s);
  gate_.let_go();
  const Status done = scanner.wait_until_done(patience);
  ASSERT_EQ(done.job->state, JobState::finished);
  EXPECT_GT(done.job->times.elapsed, early.job->times.elapsed);
  gate_.hold(scanner, 0);
  ASSERT_TRUE(scanner.start(few_snapshots(8)));
  EXPECT_TRUE(has_time_left(wait_until(scanner, has_time_left)))
      << "the scan before tells how long this one takes";
}

TEST_F(ScannerTest, CallsAScanInterruptedThatItsOwnEndCutsShort) {
  std::string id;
  {
    Scanner scanner(gate_.before(rig()), {}, store_);
    gate_.hold(scanner, 1);
    id = scanner.start(few_snapshots())->id;
    wait_for_snapshots(scanner, 1);
  }
  EXPECT_EQ(store_.find(id)->state, JobState::interrupted);
  EXPECT_EQ(store_.find(id)->failure->code, ErrorCode::interrupted);
  EXPECT_EQ(read_scan(store_.folder(id)).shots.size(), 1U);
}

}  // namespace
}  // namespace octurn
