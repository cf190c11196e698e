#pragma once

#include <cstddef>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include "failure.hpp"

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

/// Explains why a job waits, for people.
std::string describe_wait(const SlurmJob& job);

/// Explains by Slurm's state why an ended job left no model.
Failure describe_end(const SlurmJob& job);

}  // namespace octurn
