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

}  // namespace octurn
