#include "store/scan_store.hpp"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/file.hpp"
#include "octurn/scan_folder.hpp"
#include "store/build_file.hpp"
#include "store/job_file.hpp"
#include "store/scan_id.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

// Names of unfinished folders begin with a dot: they are not listed, and the next start removes
// them.
constexpr std::string_view unfinished = ".new-";

int count_snapshots(const fs::path& folder) {
  try {
    return static_cast<int>(read_scan(folder).shots.size());
  } catch (const std::exception&) {
    return 0;  // the scan ended before its first snapshot, which writes scan.json
  }
}

/// Loads the scan of a folder. One that cannot be read gets the state failed.
Job load(const fs::path& folder) {
  Job job;
  try {
    job = read_job(folder);
  } catch (...) {
    const Failure failure = current_failure();
    job.state = JobState::failed;
    job.phase = Phase::done;
    job.failure =
        Failure{.code = failure.code == ErrorCode::read_failed ? ErrorCode::read_failed
                                                               : ErrorCode::job_malformed,
                .detail = "job.json: " + failure.detail,
                .hint = "Its snapshots may still be good; octurn reconstruct reads them."};
  }
  job.id = folder.filename().string();
  job.label = read_label(folder);
  clear_unfinished(folder / builds_folder);
  job.builds.all = read_builds(folder);
  return job;
}

/// Makes `scans`, a subfolder of `data`, and locks `data`.
FileDescriptor make_and_lock(const fs::path& data, const fs::path& scans) {
  std::error_code error;
  fs::create_directories(scans, error);
  if (error) {
    throw_data_error(scans, "make the folder", error);
  }
  return lock_data_folder(data);
}

/// Milliseconds since 1970: above the revisions of earlier processes, so that clients list the
/// scans again.
std::uint64_t first_revision() {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::floor<std::chrono::milliseconds>(now).count());
}

[[noreturn]] void throw_no_such_scan(std::string_view id) {
  throw Error(ErrorCode::no_such_scan, "there is no scan " + std::string(id),
              "GET /api/v1/scans lists them.");
}

}  // namespace

ScanStore::ScanStore(fs::path data)
    : data_(std::move(data)),
      scans_(data_ / "scans"),
      platform_(data_ / "platform.json"),
      lock_(make_and_lock(data_, scans_)),
      bin_(data_ / "bin", load),
      revision_(first_revision()) {
  clear_unfinished_json(data_);
  clear_unfinished(scans_);
  for (const std::string& id : names_in(scans_)) {
    std::error_code unknown;
    if (is_scan_id(id) && fs::is_directory(folder(id), unknown)) {
      jobs_.emplace(id, load(folder(id)));
    }
  }
  recover();
  finish_discards();
}

Job ScanStore::create(const ScanSettings& settings, const std::optional<PoseOf>& pose_of) {
  make_room(max_scan_bytes(settings),
            "a scan of " + std::to_string(settings.snapshots) + " snapshots");
  const std::lock_guard writing(writing_);
  const ScanTime now = next_time();
  Job job{.id = to_scan_id(now),
          .times = {.created = utc_text(now, rfc3339)},
          .settings = settings,
          .pose_of = pose_of};

  const fs::path beginning = scans_ / (std::string(unfinished) + job.id);
  std::error_code error;
  fs::create_directory(beginning, error);
  if (error) {
    throw_data_error(beginning, "make the folder", error);
  }
  enter(beginning, job);
  return job;
}

/// Writes `job.json` into a temporary folder, and renames it to the scan's. `writing_` is held.
void ScanStore::enter(const fs::path& beginning, const Job& job) {
  write_file(beginning / "job.json", to_job_text(job));
  std::error_code error;
  fs::rename(beginning, folder(job.id), error);
  if (error) {
    throw_data_error(folder(job.id), "make the folder", error);
  }
  sync_folder(scans_);
  const std::lock_guard lock(mutex_);
  jobs_.emplace(job.id, job);
  ++revision_;
}

ScanTime ScanStore::next_time() const {
  const auto now = std::chrono::floor<ScanTime::duration>(std::chrono::system_clock::now());
  const std::string newest = newest_id();
  return newest.empty() ? now : std::max(now, to_time(newest) + ScanTime::duration(1));
}

void ScanStore::save(const Job& job) {
  const std::lock_guard writing(writing_);
  const Job stored = get(job.id);
  keep(with_stored_changes(job, stored));
  if (job.state != JobState::running || stored.state != JobState::running) {
    const std::lock_guard lock(mutex_);
    ++revision_;
  }
}

Job ScanStore::update(std::string_view id, const std::function<void(Job&)>& change) {
  const std::lock_guard writing(writing_);
  Job job = get(id);
  change(job);
  keep(job);
  const std::lock_guard lock(mutex_);
  ++revision_;
  return job;
}

/// Writes `job.json`, then changes the scan in memory. `writing_` is held.
void ScanStore::keep(const Job& job) {
  write_job(job);
  const std::lock_guard lock(mutex_);
  jobs_.find(job.id)->second = job;
}

/// `writing_` is held.
void ScanStore::write_job(const Job& job) const {
  write_file(folder(job.id) / "job.json", to_job_text(job));
}

Job ScanStore::interrupt(std::string_view id) {
  const int snapshots = count_snapshots(folder(id));
  const std::lock_guard writing(writing_);
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(id);
  if (found == jobs_.end()) {
    throw_no_such_scan(id);
  }
  found->second = to_interrupted(found->second, snapshots);
  ++revision_;
  return found->second;
}

std::vector<Job> ScanStore::list() const {
  const std::lock_guard lock(mutex_);
  std::vector<Job> jobs;
  jobs.reserve(jobs_.size());
  for (const auto& [id, job] : jobs_) {
    jobs.push_back(job);
  }
  return jobs;
}

std::optional<Job> ScanStore::find(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? std::nullopt : std::optional(found->second);
}

Job ScanStore::get(std::string_view id) const {
  std::optional<Job> job = find(id);
  if (!job) {
    throw_no_such_scan(id);
  }
  return *std::move(job);
}

std::string ScanStore::newest_id() const {
  const std::lock_guard lock(mutex_);
  return std::max(jobs_.empty() ? "" : jobs_.begin()->first, bin_.newest_id());
}

std::optional<Job> ScanStore::newest_finished() const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(jobs_, [](const auto& entry) {
    return entry.second.state == JobState::finished && !entry.second.pose_of;
  });
  return found == jobs_.end() ? std::nullopt : std::optional(found->second);
}

void ScanStore::label(std::string_view id, const LabelChange& change) {
  const std::lock_guard writing(writing_);
  get(id);  // throws if there is no such scan
  write_label(folder(id), change);
  const std::lock_guard lock(mutex_);
  ScanLabel& label = jobs_.find(id)->second.label;
  label = changed(std::move(label), change);
  ++revision_;
}

fs::path ScanStore::folder(std::string_view id) const { return scans_ / id; }

std::uint64_t ScanStore::free_bytes() const { return free_bytes_in(scans_); }

std::uint64_t ScanStore::revision() const {
  const std::lock_guard lock(mutex_);
  return revision_;
}

void ScanStore::recover() {
  for (auto& [id, job] : jobs_) {
    if (job.state != JobState::running) {
      continue;
    }
    clear_unfinished(folder(id));
    clear_unfinished(folder(id) / "snapshots");
    job = to_interrupted(job, count_snapshots(folder(id)));
    log::info("store", "scan " + id + " was interrupted after " +
                           std::to_string(job.snapshots_done) + " snapshots");
    try {
      write_job(job);
    } catch (...) {
      // A full or read-only disk: the scan is interrupted all the same, and can be deleted.
      log::warning("store", current_failure().detail);
    }
  }
}

}  // namespace octurn
