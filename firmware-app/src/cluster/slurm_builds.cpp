#include "cluster/slurm_builds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <system_error>
#include <utility>

#include "cluster/external_build.hpp"
#include "log.hpp"
#include "octurn/file.hpp"
#include "octurn/units.hpp"
#include "process.hpp"
#include "store/builds.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

// Output format of `squeue`. The folder is the last field, as it may contain the separator and even
// newlines. Two slashes end a job, as no canonical path contains them.
constexpr const char* listed = "%i|%T|%r|%Z//";
constexpr std::string_view end_of_job = "//\n";
constexpr std::size_t listed_fields = 4;

constexpr std::array<std::string_view, 10> ended{
    "BOOT_FAIL", "CANCELLED",     "COMPLETED", "DEADLINE", "FAILED",
    "NODE_FAIL", "OUT_OF_MEMORY", "PREEMPTED", "REVOKED",  "TIMEOUT"};
constexpr std::array<std::string_view, 6> begun{"COMPLETING", "RUNNING",   "SIGNALING",
                                                "STAGE_OUT",  "SUSPENDED", "STOPPED"};

/// A reason code of Slurm's, and its explanation.
struct Meaning {
  std::string_view word;
  const char* text;
};

constexpr std::array reasons{
    Meaning{"None", "Slurm has not looked at it yet"},
    Meaning{"Resources", "it waits for processors or memory"},
    Meaning{"Priority", "other jobs come before it"},
    Meaning{"BeginTime", "Slurm runs it again in some minutes"},
    Meaning{"JobHeldUser", "it is held, until scontrol release lets it go"},
    Meaning{"JobHeldAdmin", "an administrator holds it"},
    Meaning{"PartitionDown", "its partition takes no jobs now"},
    Meaning{"PartitionInactive", "its partition starts no jobs now"},
    Meaning{"PartitionTimeLimit", "it asks for more time than its partition gives"},
    Meaning{"ReqNodeNotAvail", "the machines that it needs are not there now"},
    Meaning{"Reservation", "the machines are reserved"},
};

struct End {
  std::string_view state;
  ErrorCode code;
  const char* detail;
  const char* hint;
};

constexpr std::array ends{
    End{"CANCELLED", ErrorCode::interrupted, "its job was cancelled", "Build again."},
    End{"NODE_FAIL", ErrorCode::interrupted, "the machine of its job failed", "Build again."},
    End{"BOOT_FAIL", ErrorCode::interrupted, "the machine of its job did not start",
        "Build again."},
    End{"OUT_OF_MEMORY", ErrorCode::memory_limit, "its job needed more memory than it had",
        "Set a lower memory_limit_mb, or take coarser leaves."},
    End{"PREEMPTED", ErrorCode::interrupted, "its job had to make room for another",
        "Build again."},
    End{"TIMEOUT", ErrorCode::interrupted, "its job took longer than Slurm lets it",
        "Give it more time in SBATCH_TIMELIMIT, or take coarser leaves."},
};

bool is_among(std::string_view word, const auto& words) {
  return std::ranges::find(words, word) != words.end();
}

/// Returns the last line that is not empty.
std::string last_line(const std::string& text) {
  std::string last;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty()) {
      last = line;
    }
  }
  return last;
}

/// Runs one of Slurm's programs. @return its output
std::string run(const std::vector<std::string>& command, const std::stop_token& stop) {
  ProgramResult result;
  try {
    result = run_program(command, stop);
  } catch (const Error& error) {
    throw Error(ErrorCode::interrupted, std::string("Slurm: ") + error.what(),
                "Slurm has to be installed here.");
  }
  if (result.status != 0) {
    const std::string said = last_line(result.errors);
    throw Error(
        ErrorCode::interrupted,
        "Slurm: " +
            (said.empty() ? command[0] + " ended with " + std::to_string(result.status) : said),
        "Its slurmctld has to run, and a node to have what the settings threads and "
        "memory_limit_mb ask for.");
  }
  return std::move(result.output);
}

SlurmJob to_slurm_job(std::string_view text) {
  std::array<std::string, listed_fields> parts;
  for (std::size_t i = 0; i < listed_fields; ++i) {
    const std::size_t end = i + 1 < listed_fields ? text.find('|') : text.size();
    parts[i] = text.substr(0, end);
    text.remove_prefix(std::min(text.size(), parts[i].size() + 1));
  }
  return {.id = std::move(parts[0]),
          .state = std::move(parts[1]),
          .reason = std::move(parts[2]),
          .folder = std::move(parts[3])};
}

}  // namespace

bool SlurmJob::has_begun() const { return is_among(state, begun); }

bool SlurmJob::has_ended() const { return is_among(state, ended); }

void Slurm::expect_programs() const {
  for (const std::string& program : {sbatch, squeue, scancel}) {
    try {
      run_program({program, "--version"}, {});
    } catch (const Error& error) {
      throw Error(ErrorCode::bad_settings, std::string("--builds-by slurm: ") + error.what(),
                  "Install Slurm's programs, on Debian slurm-client, or leave --builds-by out.");
    }
  }
}

std::string Slurm::submit(const SlurmRequest& request, const std::stop_token& stop) const {
  std::vector<std::string> command{sbatch,
                                   "--parsable",
                                   "--job-name=" + std::string(build_job_name),
                                   "--chdir=" + request.folder.string(),
                                   "--output=job.log",
                                   "--open-mode=append",
                                   "--nodes=1",
                                   "--ntasks=1",
                                   "--cpus-per-task=" + std::to_string(request.processors)};
  if (request.memory_bytes > 0) {
    const double mb = mb_from_bytes(static_cast<double>(request.memory_bytes));
    command.push_back("--mem=" + std::to_string(std::lround(std::ceil(mb))) + "M");
  }
  command.push_back(request.script);
  command.insert(command.end(), request.arguments.begin(), request.arguments.end());
  const std::string output = run(command, stop);
  std::string id = output.substr(0, output.find_first_of(";\n"));  // "12", or "12;cluster"
  if (id.empty() || !std::ranges::all_of(id, [](char c) { return c >= '0' && c <= '9'; })) {
    throw Error(ErrorCode::interrupted, "Slurm: " + sbatch + " did not print the job's number",
                "Check whether squeue lists the job.");
  }
  return id;
}

std::vector<SlurmJob> Slurm::list(const std::stop_token& stop) const {
  const std::string output =
      run({squeue, "--me", "--noheader", "--states=all", "--name=" + std::string(build_job_name),
           "--format=" + std::string(listed)},
          stop);
  std::vector<SlurmJob> jobs;
  std::string_view left = output;
  for (auto end = left.find(end_of_job); end != left.npos; end = left.find(end_of_job)) {
    jobs.push_back(to_slurm_job(left.substr(0, end)));
    left.remove_prefix(end + end_of_job.size());
  }
  return jobs;
}

void Slurm::cancel(const std::string& id, const std::stop_token& stop) const {
  run({scancel, id}, stop);
}

namespace {

/// Explains why a job waits, for people.
std::string describe_wait(const SlurmJob& job) {
  const auto* const found = std::ranges::find(reasons, job.reason, &Meaning::word);
  return found != reasons.end() ? found->text : "Slurm: " + job.reason;
}

/// Explains by Slurm's state why an ended job left no model.
Failure describe_end(const SlurmJob& job) {
  const auto* const found = std::ranges::find(ends, job.state, &End::state);
  if (found != ends.end()) {
    return {.code = found->code,
            .detail = std::string(found->detail) + " (Slurm's job " + job.id + ")",
            .hint = found->hint};
  }
  return {.code = ErrorCode::interrupted,
          .detail = "Slurm's job " + job.id + " has ended without a model" +
                    (job.state.empty() ? "" : ": " + job.state) +
                    (job.reason == "None" ? "" : ", " + job.reason),
          .hint = "Look into slurmd's log of the job's machine, and build again."};
}

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
