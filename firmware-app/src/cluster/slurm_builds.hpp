#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "build/build_model.hpp"
#include "failure.hpp"
#include "latest.hpp"
#include "store/scan_store.hpp"

namespace octurn {

/// The name of all jobs that build models.
inline constexpr const char* build_job_name = "octurn-build";

/// A job as squeue lists it.
struct SlurmJob {
  std::string id = {};
  std::string state = {};             ///< Slurm's job state, such as "PENDING"
  std::string reason = {};            ///< Slurm's reason for waiting or failing, or "None"
  std::filesystem::path folder = {};  ///< working directory

  bool has_begun() const;
  bool has_ended() const;
};

/// A job to submit.
struct SlurmRequest {
  std::filesystem::path script = {};
  std::vector<std::string> arguments = {};
  std::filesystem::path folder = {};  ///< working directory, where Slurm writes its output
  int processors = 1;
  std::size_t memory_bytes = 0;  ///< 0: Slurm's default
};

/// Slurm's programs, by their names in PATH or their paths.
struct Slurm {
  std::string sbatch = "sbatch";
  std::string squeue = "squeue";
  std::string scancel = "scancel";

  /// Checks that the programs can be run. @throws Error "bad-settings"  that names one that cannot
  void expect_programs() const;

  /// Submits a job. @return its id
  /// @throws Error "interrupted"  with Slurm's message, if it rejects the job; Stopped
  std::string submit(const SlurmRequest& request, const std::stop_token& stop) const;

  /// Lists this user's jobs that build models. Slurm forgets a job some minutes after its end.
  /// @throws Error "interrupted"  if Slurm does not answer; Stopped
  std::vector<SlurmJob> list(const std::stop_token& stop) const;

  /// Asks Slurm to cancel a job, which takes a moment. Has no effect on a job that has ended.
  /// @throws Error "interrupted"  if Slurm does not answer; Stopped
  void cancel(const std::string& id, const std::stop_token& stop) const;
};

/// Options of builds by Slurm.
struct SlurmOptions {
  Slurm slurm = {};
  std::string octurn = "octurn";             ///< path of the program on the cluster's machines
  std::chrono::milliseconds interval{2000};  ///< between two polls
  /// Maximum wait for the files of an ended job, which come late from other machines.
  std::chrono::milliseconds patience{60'000};
};

/// Builds by Slurm. Each is a job that runs `octurn build` in the build's folder, on a disk that
/// all machines share. The folder holds the complete state of the job, so that a process that
/// starts later finds it again:
///
///     task.json      the input of the build
///     job            Slurm's number of the job
///     progress.json  the job's progress
///     Scan.stl, build.json, or failure.json   the result
///
/// Thread-safe. Its own thread submits jobs, and polls them.
class SlurmBuilds {
 public:
  /// Finds the builds of an earlier process again. @throws Error  if a store cannot be read
  SlurmBuilds(SlurmOptions options, ScanStore& store, const Limits& limits);

  /// Queues a build for submission. If Slurm rejects it, that becomes the failure of the run.
  /// @param run  gets its number here
  /// @throws Error "no-such-scan", "no-model", "disk-full", "data-failed"
  BuildRun add(BuildRun run, bool becomes_model);

  /// Asks a build to stop. @return false if it has ended already, or is not one of these
  bool cancel(std::string_view id, int number);

  /// Builds that wait or run, and each scan's last one that left no model.
  const Latest<std::vector<BuildRun>>& runs() const { return runs_; }

  /// Whether a build of a scan waits or runs.
  bool is_building(std::string_view id) const;

 private:
  struct Entry {
    BuildTask task = {};
    std::filesystem::path folder = {};
    std::string job = {};  ///< Slurm's number; empty before the submission
    bool is_unwanted = false;
    std::optional<std::chrono::steady_clock::time_point> gone = {};  ///< ended then, without files

    BuildRun& run() { return task.run; }
  };

  void find_again();
  void work(const std::stop_token& stop);
  void poll(const std::stop_token& stop);
  std::vector<Entry> entries();
  void update(Entry& entry, const std::vector<SlurmJob>& jobs, const std::stop_token& stop);
  void submit(Entry& entry, const std::stop_token& stop);
  void keep(Entry& entry);
  void choose(const BuildTask& task);
  void end_without_files(Entry& entry, const SlurmJob& job);
  void end(Entry& entry, BuildRun::State state, const std::optional<Failure>& failure);
  void publish(const BuildRun& run);

  SlurmOptions options_;
  ScanStore& store_;
  Limits limits_;
  Latest<std::vector<BuildRun>> runs_;
  std::mutex mutex_;  // guards the members below
  std::condition_variable_any changed_;
  std::vector<Entry> entries_;  // that have not ended
  bool wake_ = false;           // before the next poll
  std::jthread thread_;         // the last member, so that it ends first
};

}  // namespace octurn
