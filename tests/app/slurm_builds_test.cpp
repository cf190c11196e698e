// Builds by Slurm, whose programs are replaced by scripts. Tests with a real Slurm are in
// tests/cluster.

#include "cluster/slurm_builds.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>

#include "app/slurm_scripts.hpp"
#include "cluster/external_build.hpp"
#include "run/scanner.hpp"
#include "support/archive.hpp"
#include "support/patience.hpp"
#include "support/small_scan.hpp"
#include "support/temporary_folder.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

class SlurmBuildsTest : public ::testing::Test {
 protected:
  SlurmBuilds start() {
    return {slurm_.options(), store_, {.threads = 1, .memory_bytes = 64U << 20U}};
  }

  /// Stores a scan without a model.
  Job store_scan() {
    const fs::path beginning = store_.begin_import();
    write_small_scan(beginning, 2);
    return store_.adopt(beginning);
  }

  static BuildRun run_of(const Job& scan) {
    BuildRun run{.scan = scan.id, .snapshots = 2, .settings = {.scan = scan.settings}};
    run.settings.scan.method = Method::intersection;
    run.settings.scan.leaf_size = 0.004;
    return run;
  }

  fs::path folder_of(const BuildRun& run) const {
    return fs::canonical(store_.folder(run.scan)) / "builds" / std::to_string(run.number);
  }

  /// Sets squeue's answer about the build's job.
  void say(const std::string& state, const std::string& reason, const BuildRun& run,
           const std::string& job = "12") const {
    slurm_.say(state, reason, folder_of(run), job);
  }

  /// Waits until a scan's run is as wanted; returns nothing if the run is gone.
  static std::optional<BuildRun> wait_until(const SlurmBuilds& builds,
                                            const std::function<bool(const BuildRun&)>& wanted) {
    const auto runs = builds.runs().wait({}, patience, [&](const std::vector<BuildRun>& all) {
      return all.empty() || wanted(all.front());
    });
    return runs->empty() ? std::nullopt : std::optional(runs->front());
  }

  static std::optional<BuildRun> wait_for_end(const SlurmBuilds& builds) {
    return wait_until(builds, [](const BuildRun& seen) { return seen.has_ended(); });
  }

  /// Starts a build, and waits until it has a job id.
  static BuildRun begin(SlurmBuilds& builds, const Job& scan) {
    const BuildRun run = builds.add(run_of(scan), true);
    wait_until(builds, [](const BuildRun& seen) { return !seen.cluster_job->id.empty(); });
    return run;
  }

  SlurmScripts slurm_ = {};
  TemporaryFolder folder_ = {};
  ScanStore store_{folder_.path() / "data"};
};

TEST_F(SlurmBuildsTest, ABuildIsAJobThatMakesTheModelOfTheScan) {
  const Job scan = store_scan();
  SlurmBuilds builds = start();
  const BuildRun run = begin(builds, scan);
  EXPECT_EQ(run.state, BuildRun::State::waiting);
  EXPECT_TRUE(builds.is_building(scan.id));

  say("PENDING", "Resources", run);
  auto now =
      wait_until(builds, [](const BuildRun& seen) { return !seen.cluster_job->detail.empty(); });
  ASSERT_TRUE(now);
  EXPECT_EQ(now->state, BuildRun::State::waiting);
  EXPECT_EQ(now->cluster_job->id, "12");
  EXPECT_EQ(now->cluster_job->detail, "it waits for processors or memory");
  const std::string submitted = slurm_.lines("submitted");
  EXPECT_NE(submitted.find("--cpus-per-task=1 --mem=64M "), std::string::npos) << submitted;
  EXPECT_NE(submitted.find(" /opt/octurn " + folder_of(run).string() + "\n"), std::string::npos);

  say("RUNNING", "None", run);
  put(folder_of(run) / "progress.json", R"({"phase": "rebuilding", "snapshots_done": 1})");
  now = wait_until(builds, [](const BuildRun& seen) { return seen.snapshots_done == 1; });
  ASSERT_TRUE(now);
  EXPECT_EQ(now->state, BuildRun::State::running);
  EXPECT_EQ(now->phase, Phase::rebuilding);

  ASSERT_TRUE(build_task_in(folder_of(run), {}));
  EXPECT_FALSE(wait_for_end(builds)) << "a finished build is told by its model";

  const Job built = store_.get(scan.id);
  EXPECT_EQ(built.state, JobState::finished);
  ASSERT_NE(chosen_model(built), nullptr);
  EXPECT_GT(chosen_model(built)->report.triangles, 100U);
  EXPECT_EQ(built.builds.all.front().settings.scan.leaf_size, 0.004);
  EXPECT_FALSE(builds.is_building(scan.id));
  const std::vector<std::string> left = names_in(folder_of(run));
  EXPECT_EQ(left.size(), 2U);
  EXPECT_EQ(std::ranges::count(left, "Scan.stl") + std::ranges::count(left, "build.json"), 2);
}

TEST_F(SlurmBuildsTest, AFolderMayHaveANewlineInItsName) {
  slurm_.program("squeue",
                 R"(printf '12|RUNNING|None|/data/a\n13|b//\n14|PENDING|Priority|/data/c//\n')");
  const std::vector<SlurmJob> jobs = slurm_.options().slurm.list({});
  ASSERT_EQ(jobs.size(), 2U);
  EXPECT_EQ(jobs[0].folder, "/data/a\n13|b");
  EXPECT_EQ(jobs[1].id, "14");
  EXPECT_EQ(jobs[1].reason, "Priority");
  EXPECT_EQ(jobs[1].folder, "/data/c");
}

TEST_F(SlurmBuildsTest, WhatSlurmRefusesFailsInItsWords) {
  const Job scan = store_scan();
  slurm_.program("sbatch", "echo 'sbatch: error: invalid partition specified: small' >&2; exit 1");
  SlurmBuilds builds = start();
  const BuildRun run = builds.add(run_of(scan), true);

  const auto ended = wait_for_end(builds);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->state, BuildRun::State::failed);
  EXPECT_EQ(ended->failure->detail, "Slurm: sbatch: error: invalid partition specified: small");
  EXPECT_FALSE(ended->failure->hint.empty());
  EXPECT_FALSE(fs::exists(folder_of(run)));
  EXPECT_EQ(store_.get(scan.id).state, JobState::interrupted) << "the scan is as it was";
}

TEST_F(SlurmBuildsTest, WithoutSlurmsProgramsItSaysSo) {
  SlurmOptions without = slurm_.options();
  without.slurm.sbatch = slurm_.at("no-sbatch");
  try {
    without.slurm.expect_programs();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::bad_settings);
    EXPECT_NE(std::string(error.what()).find("no-sbatch: cannot be run: No such file"),
              std::string::npos);
  }
  slurm_.options().slurm.expect_programs();

  SlurmBuilds builds(without, store_, {});
  builds.add(run_of(store_scan()), true);
  const auto ended = wait_for_end(builds);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->state, BuildRun::State::failed);
  EXPECT_NE(ended->failure->detail.find("cannot be run"), std::string::npos);
}

TEST_F(SlurmBuildsTest, CancellingIsScancelAndTheFolderGoesWhenTheJobHas) {
  const Job scan = store_scan();
  SlurmBuilds builds = start();
  const BuildRun run = begin(builds, scan);
  say("RUNNING", "None", run);
  wait_until(builds, [](const BuildRun& seen) { return seen.state == BuildRun::State::running; });

  EXPECT_FALSE(builds.cancel(scan.id, run.number + 1));
  slurm_.program("scancel", "echo \"$@\" >>'" + slurm_.at("cancelled") +
                                "'; sed 's/RUNNING/CANCELLED/' '" + slurm_.at("queue") + "' >'" +
                                slurm_.at("queue.next") + "'; mv '" + slurm_.at("queue.next") +
                                "' '" + slurm_.at("queue") + "'");
  EXPECT_TRUE(builds.cancel(scan.id, run.number));
  const auto ended = wait_for_end(builds);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->state, BuildRun::State::cancelled);
  EXPECT_FALSE(ended->failure);
  EXPECT_EQ(slurm_.lines("cancelled"), "12\n");
  EXPECT_FALSE(fs::exists(folder_of(run)));
  EXPECT_FALSE(builds.cancel(scan.id, run.number)) << "it has ended";
}

TEST_F(SlurmBuildsTest, AJobThatFailsTellsWhy) {
  const Job scan = store_scan();
  SlurmBuilds builds = start();
  BuildRun run = builds.add(run_of(scan), true);
  say("TIMEOUT", "TimeLimit", run);
  auto ended = wait_for_end(builds);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->failure->detail, "its job took longer than Slurm lets it (Slurm's job 12)");

  slurm_.program("sbatch", "echo 13");
  run = builds.add(run_of(scan), true);  // replaces the failed run
  EXPECT_EQ(builds.runs().get()->size(), 1U);
  fs::remove(store_.folder(scan.id) / "scan.json");
  EXPECT_THROW(build_task_in(folder_of(run), {}), Error);
  say("FAILED", "NonZeroExitCode", run, "13");
  ended = wait_for_end(builds);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->state, BuildRun::State::failed);
  EXPECT_NE(ended->failure->detail.find("scan.json"), std::string::npos) << ended->failure->detail;
}

TEST_F(SlurmBuildsTest, AJobThatSlurmHasForgottenHasFailed) {
  SlurmOptions impatient = slurm_.options();
  impatient.patience = {};
  SlurmBuilds builds(impatient, store_, {.threads = 1});
  builds.add(run_of(store_scan()), true);
  const auto ended = wait_for_end(builds);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->state, BuildRun::State::failed);
  EXPECT_EQ(ended->failure->detail, "Slurm's job 12 has ended without a model");
}

TEST_F(SlurmBuildsTest, WhileSlurmDoesNotAnswerBuildsGoOn) {
  slurm_.program("squeue",
                 "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1");
  const Job scan = store_scan();
  SlurmBuilds builds = start();
  const BuildRun run = builds.add(run_of(scan), true);
  const auto now =
      wait_until(builds, [](const BuildRun& seen) { return !seen.cluster_job->detail.empty(); });
  ASSERT_TRUE(now);
  EXPECT_EQ(now->state, BuildRun::State::waiting);
  EXPECT_NE(now->cluster_job->detail.find("Unable to contact"), std::string::npos);

  ASSERT_TRUE(build_task_in(folder_of(run), {}));
  EXPECT_FALSE(wait_for_end(builds)) << "its files tell that it has ended";
  EXPECT_NE(chosen_model(store_.get(scan.id)), nullptr);
}

TEST_F(SlurmBuildsTest, AProcessThatStartsLaterFindsItsJobsAgain) {
  const Job scan = store_scan();
  BuildRun run;
  {
    SlurmBuilds builds = start();
    run = begin(builds, scan);
    say("PENDING", "Priority", run);
    wait_until(builds, [](const BuildRun& seen) { return !seen.cluster_job->detail.empty(); });
  }
  fs::remove(folder_of(run) / "job");  // as after a power cut before it was written
  {
    SlurmBuilds builds = start();
    EXPECT_TRUE(builds.is_building(scan.id));
    const auto now =
        wait_until(builds, [](const BuildRun& seen) { return !seen.cluster_job->detail.empty(); });
    ASSERT_TRUE(now);
    EXPECT_EQ(now->number, run.number);
    EXPECT_EQ(now->settings.scan.leaf_size, 0.004);
  }
  const std::string submitted = slurm_.lines("submitted");
  EXPECT_EQ(std::ranges::count(submitted, '\n'), 1) << submitted;

  ASSERT_TRUE(build_task_in(folder_of(run), {}));  // while no daemon runs
  put(slurm_.at("queue"), "");
  SlurmBuilds builds = start();
  EXPECT_FALSE(wait_for_end(builds));
  const Job built = store_.get(scan.id);
  EXPECT_EQ(built.builds.chosen, run.number);
  EXPECT_EQ(built.builds.all.size(), 1U);
}

TEST_F(SlurmBuildsTest, AScannerHasUploadedScansBuiltSo) {
  Scanner scanner({.sensor_uri = "octurn-simulator://"}, {.threads = 1}, store_, slurm_.options());
  const TemporaryFolder other;
  write_small_scan(other.path(), 2);
  const Job scan = scanner.adopt(source_of(archive_of(other.path())));
  ASSERT_EQ(scanner.build_runs().size(), 1U);
  const BuildRun run = scanner.build_runs().front();
  EXPECT_EQ(run.scan, scan.id);
  EXPECT_THROW(scanner.remove(scan.id), Error) << "a model of it is being built";
  EXPECT_THROW(scanner.resume(scan.id), Error);
  EXPECT_FALSE(scanner.status().busy());

  say("RUNNING", "None", run);
  ASSERT_TRUE(build_task_in(folder_of(run), {}));
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!scanner.slurm_runs()->empty() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_EQ(scanner.find(scan.id).state, JobState::finished);
  EXPECT_NE(chosen_model(scanner.find(scan.id)), nullptr);
}

}  // namespace
}  // namespace octurn
