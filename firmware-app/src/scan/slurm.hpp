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
  std::string state = {};             ///< a word of Slurm's, such as "PENDING"
  std::string reason = {};            ///< why it waits or failed, a word of Slurm's; "None"
  std::filesystem::path folder = {};  ///< its working directory

  bool has_begun() const;
  bool has_ended() const;
};

/// A job to come.
struct SlurmRequest {
  std::filesystem::path script = {};
  std::vector<std::string> arguments = {};
  std::filesystem::path folder = {};  ///< its working directory, which gets its output
  int processors = 1;
  std::size_t memory_bytes = 0;  ///< 0: as much as Slurm gives by default
};

/// Slurm's programs, by their names in PATH or their paths.
struct Slurm {
  std::string sbatch = "sbatch";
  std::string squeue = "squeue";
  std::string scancel = "scancel";

  /// @throws Error "bad-settings"  that names a program which cannot be run
  void expect_programs() const;

  /// @return the job's id
  /// @throws Error "interrupted"  with Slurm's words, if it takes no such job; Stopped
  std::string submit(const SlurmRequest& request, const std::stop_token& stop) const;

  /// The jobs of this user that build models. Slurm forgets a job some minutes after its end.
  /// @throws Error "interrupted"  if Slurm does not answer; Stopped
  std::vector<SlurmJob> list(const std::stop_token& stop) const;

  /// Has a job end, which takes a moment; one that has ended stays as it is.
  /// @throws Error "interrupted"  if Slurm does not answer; Stopped
  void cancel(const std::string& id, const std::stop_token& stop) const;
};

/// Why a job waits, for people.
std::string describe_wait(const SlurmJob& job);

/// Why a job that has ended left no model, as far as Slurm knows.
Failure describe_end(const SlurmJob& job);

}  // namespace octurn
