#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "scan/build_task.hpp"
#include "scan/latest.hpp"
#include "scan/scan_store.hpp"
#include "scan/slurm.hpp"

namespace octurn {

/// How builds become jobs of Slurm.
struct SlurmOptions {
  Slurm slurm = {};
  std::string octurn = "octurn";  ///< the program, as the machines of the cluster find it
  std::chrono::milliseconds interval{2000};  ///< between two looks at the jobs
  /// With the files of a job that has ended, which come late from other machines.
  std::chrono::milliseconds patience{60'000};
};

/// The builds that Slurm makes. Each is a job that runs `octurn build` in the folder that its build
/// will have, on a disk that all machines share. A folder tells all of its job, so that a process
/// that starts later finds it, whatever has happened meanwhile: it has
///
///     task.json      what is to be built
///     job            the number that Slurm gave it
///     progress.json  how far it is
///     Scan.stl, build.json, or failure.json   what became of it
///
/// Any thread may call anything. A thread of its own looks at the jobs, and asks Slurm for them.
class SlurmBuilds {
 public:
  /// Finds the builds of an earlier process again. @throws Error  if a store cannot be read
  SlurmBuilds(SlurmOptions options, ScanStore& store, const Limits& limits);

  /// Has Slurm build a model, as soon as it can. What Slurm says against it becomes the failure of
  /// the run.
  /// @param run  whose number is given by this
  /// @throws Error "no-such-scan", "no-model", "disk-full", "data-failed"
  BuildRun add(BuildRun run, bool becomes_model);

  /// Asks a build to end. @return false if it has ended already, or is none of these
  bool cancel(std::string_view id, int number);

  /// Those that wait or go on, and of each scan the last one that left no model.
  const Latest<std::vector<BuildRun>>& runs() const { return runs_; }

  /// Whether one of a scan waits or goes on.
  bool is_building(std::string_view id) const;

 private:
  struct Entry {
    BuildTask task = {};
    std::filesystem::path folder = {};
    std::string job = {};  ///< its number; empty before it has one
    bool is_unwanted = false;
    std::optional<std::chrono::steady_clock::time_point> gone = {};  ///< since then, without files

    BuildRun& run() { return task.run; }
  };

  void find_again();
  void work(const std::stop_token& stop);
  void look(const std::stop_token& stop);
  std::vector<Entry> entries();
  void look_at(Entry& entry, const std::vector<SlurmJob>& jobs, const std::stop_token& stop);
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
  std::mutex mutex_;  // guards what follows
  std::condition_variable_any changed_;
  std::vector<Entry> entries_;  // that have not ended
  bool is_news_ = false;        // there is something to do before the next look
  std::jthread thread_;         // the last member, so that it ends first
};

}  // namespace octurn
