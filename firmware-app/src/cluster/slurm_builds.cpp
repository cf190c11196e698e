#include "cluster/slurm_builds.hpp"

#include <algorithm>
#include <system_error>
#include <utility>

#include "cluster/external_build.hpp"
#include "log.hpp"
#include "octurn/file.hpp"
#include "store/build_file.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_job_file = 64;

bool is_same_build(const BuildRun& a, const BuildRun& b) {
  return a.scan == b.scan && a.number == b.number;
}

/// Whether two runs look the same to clients.
bool looks_same(const BuildRun& a, const BuildRun& b) {
  return a.state == b.state && a.phase == b.phase && a.snapshots_done == b.snapshots_done &&
         a.cluster_job->id == b.cluster_job->id && a.cluster_job->detail == b.cluster_job->detail;
}

/// The job's script. Program and folder are arguments, so that no character of theirs needs
/// quoting.
constexpr std::string_view script = "#!/bin/sh\nexec \"$1\" build \"$2\"\n";

/// Returns the job of that number. Without a number, returns the job of that folder that has not
/// ended: ended jobs may be those of earlier builds. Null if there is none.
const SlurmJob* find_job(const std::vector<SlurmJob>& jobs, const std::string& id,
                         const fs::path& folder) {
  const auto found = std::ranges::find_if(jobs, [&](const SlurmJob& job) {
    return id.empty() ? job.folder == folder && !job.has_ended() : job.id == id;
  });
  return found == jobs.end() ? nullptr : &*found;
}

/// Stores a job's number. A failure is only logged, because a job can be found by its folder, too.
void keep_number(const fs::path& folder, const std::string& job) {
  try {
    write_file(folder / job_file, job);
  } catch (const Error& error) {
    log::warning("slurm", error.what());
  }
}

}  // namespace

SlurmBuilds::SlurmBuilds(SlurmOptions options, ScanStore& store, const Limits& limits)
    : options_(std::move(options)), store_(store), limits_(limits) {
  find_again();
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

void SlurmBuilds::find_again() {
  for (const Job& job : store_.list()) {
    const fs::path builds = store_.folder(job.id) / builds_folder;
    for (const std::string& name : names_in(builds)) {
      std::error_code unknown;
      if (to_build_number(name) == 0) {
        continue;
      }
      if (!fs::exists(builds / name / task_file, unknown)) {
        fs::remove(builds / name, unknown);  // only if empty: a power cut came before its task
        continue;
      }
      try {
        Entry entry{.task = read_task(builds / name).task, .folder = fs::canonical(builds / name)};
        entry.job = read_regular_file(entry.folder / job_file, max_job_file).value_or("");
        entry.run().cluster_job = ClusterJob{.id = entry.job};
        log::info("slurm", describe(entry.run()) + " found again");
        publish(entry.run());
        entries_.push_back(std::move(entry));
      } catch (...) {
        log::warning("slurm", (builds / name).string() + ": " + current_failure().detail);
      }
    }
  }
  wake_ = !entries_.empty();
}

BuildRun SlurmBuilds::add(BuildRun run, bool becomes_model) {
  const fs::path folder = store_.reserve_build(run);
  run.created = utc_text(std::chrono::system_clock::now(), rfc3339);
  run.cluster_job.emplace();
  Entry entry{.folder = folder};
  try {
    entry.task = make_task(store_, run, becomes_model);
    entry.folder = fs::canonical(folder);
    write_task(folder, entry.task, limits_);
    sync_folder(folder.parent_path());
  } catch (...) {
    store_.release_build(run.scan, run.number);
    throw;
  }
  runs_.update([&](std::vector<BuildRun>& runs) {
    std::erase_if(runs, [&](const BuildRun& old) {
      return is_same_build(old, run) || (old.scan == run.scan && old.has_ended());
    });
  });
  publish(run);
  {
    const std::lock_guard lock(mutex_);
    entries_.push_back(std::move(entry));
    wake_ = true;
  }
  changed_.notify_all();
  return run;
}

bool SlurmBuilds::cancel(std::string_view id, int number) {
  const auto is_meant = [&](const BuildRun& run) {
    return run.scan == id && run.number == number && !run.has_ended();
  };
  if (std::ranges::none_of(*runs_.get(), is_meant)) {
    return false;
  }
  {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::ranges::find_if(entries_, [&](Entry& entry) { return is_meant(entry.run()); });
    if (found == entries_.end()) {
      return false;
    }
    found->is_unwanted = true;
    wake_ = true;
  }
  changed_.notify_all();
  return true;
}

bool SlurmBuilds::is_building(std::string_view id) const {
  return std::ranges::any_of(
      *runs_.get(), [&](const BuildRun& run) { return run.scan == id && !run.has_ended(); });
}

void SlurmBuilds::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      if (entries_.empty()) {
        changed_.wait(lock, stop, [&] { return wake_; });
      } else {
        changed_.wait_for(lock, stop, options_.interval, [&] { return wake_; });
      }
      wake_ = false;
    }
    try {
      poll(stop);
    } catch (const Stopped&) {
      return;
    } catch (...) {
      log::error("slurm", current_failure().detail);
    }
  }
}

/// Publishes a run. A finished run is removed: its build in the store replaces it.
void SlurmBuilds::publish(const BuildRun& run) {
  const auto now = runs_.get();
  const auto old =
      std::ranges::find_if(*now, [&](const BuildRun& other) { return is_same_build(run, other); });
  if (old != now->end() && looks_same(*old, run)) {
    return;  // does not wake watchers
  }
  runs_.update([&](std::vector<BuildRun>& runs) {
    const auto held = std::ranges::find_if(
        runs, [&](const BuildRun& other) { return is_same_build(run, other); });
    if (held == runs.end()) {
      runs.push_back(run);
    } else if (run.state == BuildRun::State::finished) {
      runs.erase(held);
    } else {
      *held = run;
    }
  });
}

std::vector<SlurmBuilds::Entry> SlurmBuilds::entries() {
  const std::lock_guard lock(mutex_);
  return entries_;
}

void SlurmBuilds::poll(const std::stop_token& stop) {
  std::vector<Entry> now = entries();
  if (now.empty()) {
    return;
  }
  std::optional<std::vector<SlurmJob>> jobs;
  std::string trouble;
  try {
    jobs = options_.slurm.list(stop);
  } catch (const Error& error) {
    trouble = error.what();
    if (now.front().run().cluster_job->detail != trouble) {  // once, not at each poll
      log::warning("slurm", trouble);
    }
  }
  for (Entry& entry : now) {
    if (jobs) {
      update(entry, *jobs, stop);
    } else if (is_built(entry.folder)) {
      keep(entry);
    } else {
      entry.run().cluster_job->detail = trouble;
      publish(entry.run());
    }
    const std::lock_guard lock(mutex_);
    const auto held = std::ranges::find(entries_, entry.folder, &Entry::folder);
    if (entry.run().has_ended()) {
      entries_.erase(held);
    } else {
      entry.is_unwanted = held->is_unwanted;  // may have been set meanwhile
      *held = entry;
    }
  }
}

void SlurmBuilds::update(Entry& entry, const std::vector<SlurmJob>& jobs,
                         const std::stop_token& stop) {
  const SlurmJob* const job = find_job(jobs, entry.job, entry.folder);
  BuildRun& run = entry.run();
  const auto cancelled = [&] { end(entry, BuildRun::State::cancelled, {}); };
  if (is_built(entry.folder)) {
    keep(entry);
  } else if (job == nullptr && entry.job.empty()) {
    entry.is_unwanted ? cancelled() : submit(entry, stop);
  } else if (job != nullptr && !job->has_ended()) {
    if (entry.is_unwanted) {
      options_.slurm.cancel(job->id, stop);
    }
    entry.job = job->id;
    run.state = job->has_begun() ? BuildRun::State::running : BuildRun::State::waiting;
    run.cluster_job = ClusterJob{.id = job->id};
    if (job->has_begun()) {
      read_progress(entry.folder, run);
    } else {
      run.cluster_job->detail = describe_wait(*job);
    }
    publish(run);
  } else if (entry.is_unwanted) {
    cancelled();
  } else if (const auto failure = read_failure(entry.folder)) {
    end(entry, BuildRun::State::failed, *failure);
  } else if (job != nullptr && job->state == "CANCELLED") {
    end(entry, BuildRun::State::cancelled, describe_end(*job));
  } else if (job != nullptr && job->state != "COMPLETED") {
    end(entry, BuildRun::State::failed, describe_end(*job));
  } else {
    end_without_files(entry, job != nullptr ? *job : SlurmJob{.id = entry.job, .reason = "None"});
  }
}

/// Gives up on a job that completed, or that Slurm has forgotten, if its files do not come in time.
void SlurmBuilds::end_without_files(Entry& entry, const SlurmJob& job) {
  const auto now = std::chrono::steady_clock::now();
  if (!entry.gone) {
    entry.gone = now;
  }
  if (now - *entry.gone >= options_.patience) {
    end(entry, BuildRun::State::failed, describe_end(job));
  }
}

void SlurmBuilds::submit(Entry& entry, const std::stop_token& stop) {
  try {
    write_file(entry.folder / script_file, script);
    entry.job = options_.slurm.submit({.script = entry.folder / script_file,
                                       .arguments = {options_.octurn, entry.folder},
                                       .folder = entry.folder,
                                       .processors = limits_.threads,
                                       .memory_bytes = limits_.memory_bytes},
                                      stop);
    keep_number(entry.folder, entry.job);
    entry.run().cluster_job->id = entry.job;
    log::info("slurm", describe(entry.run()) + " is job " + entry.job);
    publish(entry.run());
  } catch (const Error& error) {
    end(entry, BuildRun::State::failed, to_failure(error));
  }
}

/// Adds the finished build of a job's folder to the store.
void SlurmBuilds::keep(Entry& entry) {
  const BuildRun& run = entry.run();
  try {
    store_.take_build(run.scan, run.number);
  } catch (...) {
    end(entry, BuildRun::State::failed, current_failure());
    return;
  }
  try {
    choose(entry.task);
  } catch (...) {  // the model exists, and a person can choose it
    log::error("slurm", describe(run) + ": " + current_failure().detail);
  }
  clear_work_files(entry.folder);
  entry.run().state = BuildRun::State::finished;
  entry.run().phase = Phase::done;
  log::info("slurm", describe(run) + " finished");
  publish(run);
}

void SlurmBuilds::choose(const BuildTask& task) {
  const Job scan = store_.update(task.run.scan, [&](Job& stored) {
    if (stored.state == JobState::interrupted) {  // it had all snapshots, and waited for its model
      stored.state = JobState::finished;
      stored.failure.reset();
      stored.builds.chosen = task.run.number;
    }
  });
  if (scan.builds.chosen != task.run.number) {
    choose_built(store_, task);
  }
}

void SlurmBuilds::end(Entry& entry, BuildRun::State state, const std::optional<Failure>& failure) {
  BuildRun& run = entry.run();
  store_.release_build(run.scan, run.number);
  run.state = state;
  run.phase = Phase::done;
  run.failure = failure;
  run.cluster_job->detail.clear();
  log::info("slurm", describe(run) + " " + std::string(to_string(state)) +
                         (failure ? ": " + failure->detail : ""));
  publish(run);
}

}  // namespace octurn
