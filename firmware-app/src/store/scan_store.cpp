#include "store/scan_store.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/tiles.hpp"
#include "store/builds.hpp"
#include "store/job.hpp"
#include "store/job_file.hpp"
#include "store/job_json.hpp"
#include "store/stored_scan.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

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
  clear_unfinished(folder);
  clear_unfinished(folder / builds_folder);
  job.builds.all = read_builds(folder);
  return job;
}

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw_data_error(folder, "make the folder", error);
  }
}

/// Makes `scans`, a subfolder of `data`, and locks `data`.
FileDescriptor make_and_lock(const fs::path& data, const fs::path& scans) {
  make_folder(scans);
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

bool is_there(const fs::path& path) {
  std::error_code unknown;
  return fs::exists(path, unknown);
}

void move_folder(const fs::path& from, const fs::path& to) {
  std::error_code error;
  fs::rename(from, to, error);
  if (error) {
    throw_data_error(from, "move", error);
  }
}

/// Returns the number of the build to choose without a pose: the one that was chosen before the
/// first build with that pose; 0 if it was removed.
int build_before(const Job& job, const std::string& pose) {
  const auto first = std::ranges::find_if(
      job.builds.all, [&](const Build& build) { return has_pose(build, pose); });
  if (first == job.builds.all.end() || find_build(job, first->replaced) == nullptr) {
    return 0;
  }
  return first->replaced;
}

/// Whether the chosen build merges the pose.
bool has_chosen_pose(const Job& job, const std::string& pose) {
  const Build* const chosen = find_build(job, job.builds.chosen);
  return chosen != nullptr && has_pose(*chosen, pose);
}

// As for scans: the next start removes folders whose names begin with a dot.
fs::path unfinished_in(const fs::path& builds, int number) {
  return builds / (std::string(unfinished) + std::to_string(number));
}

fs::path leaving_in(const fs::path& builds, int number) {
  return builds / (".removed-" + std::to_string(number));
}

[[noreturn]] void throw_no_such_build(int number) {
  throw Error(ErrorCode::no_model, "this scan has no build " + std::to_string(number),
              "GET /api/v1/scans/ID/builds lists its builds.");
}

constexpr std::string_view unfinished_import = ".new-import-";
constexpr std::size_t max_adopted_bytes = max_job_bytes / 2;  // leaves room for the model
constexpr std::size_t max_created = 40;  // characters; "2026-11-21T08:15:00Z" has 20

/// Reads a label, and removes the files of what cannot be one.
ScanLabel read_adopted_label(const fs::path& folder) {
  const ScanLabel found = read_label(folder);
  LabelChange change;
  for (const LabelText& text : label_texts()) {
    if (!text.is_valid(found.*text.text)) {
      change.*text.change = "";
    }
  }
  write_label(folder, change);
  return changed(found, change);
}

/// Reads the job of an imported scan; default settings if the folder has no `job.json`.
/// @throws Error "bad-request"
Job read_adopted_job(const fs::path& folder, const Scan& scan) {
  Job job;
  if (std::error_code ignored; fs::exists(folder / "job.json", ignored)) {
    try {
      job = read_job(folder);
    } catch (const Error& error) {
      throw Error(ErrorCode::bad_request, std::string("job.json: ") + error.what(),
                  "Send a file that an Octurn has made: scan.zip.");
    }
  } else if (scan.laser) {
    use_laser_defaults(job.settings);
  }
  if (job.times.created.size() > max_created) {
    job.times.created.clear();
  }
  job.label = read_adopted_label(folder);
  return job;
}

/// Reads back what will be written of a job.
/// @throws Error "bad-request"  if the next start of the program could not read it, such as a clip
///               box beyond `stored_ranges`
void expect_readable(const Job& job) {
  const std::string text = to_job_text(job);
  try {
    if (text.size() > max_adopted_bytes) {
      throw Error(ErrorCode::job_malformed,
                  "its job.json would have " + std::to_string(text.size()) +
                      " bytes: must have at most " + std::to_string(max_adopted_bytes));
    }
    parse_job(text);
  } catch (const Error& error) {
    throw Error(
        ErrorCode::bad_request, std::string("this scan cannot be stored: ") + error.what(),
        "Unpack the archive, and make its model with: octurn reconstruct FOLDER -o Scan.stl");
  }
}

/// Turns a job into that of a scan with all its snapshots, which waits for its model.
Job to_waiting(Job job, const fs::path& folder, const Scan& scan) {
  job.state = JobState::interrupted;
  job.phase = Phase::done;
  job.snapshots_done = static_cast<int>(scan.shots.size());
  job.settings.snapshots = job.snapshots_done;
  job.settings.clip = scan.clip;
  job.failure = Failure{.code = ErrorCode::interrupted,
                        .detail = "this scan came from a file, and its model is not built yet",
                        .hint = "Resume it: nothing moves for that."};
  job.model.reset();
  job.builds = {};
  job.pose_of.reset();
  job.builds.have_colours = has_colours(folder, scan);
  job.builds.have_views = !scan.laser;
  return job;
}

constexpr std::size_t max_platform_bytes = 4096;

}  // namespace

ScanStore::ScanStore(fs::path data, WallClock clock)
    : data_(std::move(data)),
      scans_(data_ / "scans"),
      platform_(data_ / "platform.json"),
      clock_(std::move(clock)),
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

Job ScanStore::create(const ScanSettings& settings, const std::optional<PoseOf>& pose_of,
                      const LabelChange& label) {
  make_room(max_scan_bytes(settings),
            "a scan of " + std::to_string(settings.snapshots) + " snapshots");
  const std::lock_guard writing(writing_);
  const ScanTime now = next_time();
  Job job{.id = to_scan_id(now),
          .label = changed({}, label),
          .times = {.created = utc_text(now, rfc3339)},
          .settings = settings,
          .pose_of = pose_of};

  const fs::path beginning = scans_ / (std::string(unfinished) + job.id);
  make_folder(beginning);
  write_label(beginning, label);
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
  const std::string newest = newest_id();
  return newest.empty() ? now() : std::max(now(), to_time(newest) + ScanTime::duration(1));
}

ScanTime ScanStore::now() const { return std::chrono::floor<ScanTime::duration>(clock_.now()); }

/// Removes what was deleted long ago, by a clock that can be believed.
void ScanStore::expire_bin() {
  if (clock_.is_right()) {
    bin_.expire(now());
  }
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

Job ScanStore::interrupt(std::string_view id, const Failure& reason) {
  const int snapshots = count_snapshots(folder(id));
  const std::lock_guard writing(writing_);
  const std::lock_guard lock(mutex_);
  const auto found = jobs_.find(id);
  if (found == jobs_.end()) {
    throw_no_such_scan(id);
  }
  found->second = to_interrupted(found->second, snapshots, reason);
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

/// `writing_` is held.
void ScanStore::list(const Job& job) {
  const std::lock_guard lock(mutex_);
  jobs_.insert_or_assign(job.id, job);
  ++revision_;
}

/// `writing_` is held. The scan leaves the list before its folder does: a request that misses a
/// file then finds that there is no such scan.
void ScanStore::move_to_bin(const Job& job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.erase(job.id);
    ++revision_;
  }
  try {
    bin_.take(folder(job.id), job, now(), clock_.is_right());
  } catch (...) {
    list(job);
    throw;
  }
}

/// `writing_` is held.
void ScanStore::move_from_bin(const BinnedScan& scan) {
  bin_.put_back(scan.job.id, folder(scan.job.id));
  list(scan.job);
}

/// Moves the scan before its poses, so that `finish_discards` can complete a move that a power cut
/// interrupted.
void ScanStore::discard(std::string_view id) {
  const std::lock_guard writing(writing_);
  const Job job = get(id);
  const std::vector<Job> others = poses(id);
  move_to_bin(job);
  for (const Job& other : others) {
    move_to_bin(other);
  }
  expire_bin();
}

void ScanStore::restore(std::string_view id) {
  const std::lock_guard writing(writing_);
  const auto scan = bin_.find(id);
  if (!scan) {
    throw Error(ErrorCode::no_such_scan, "there is no scan " + std::string(id) + " in the bin",
                "GET /api/v1/bin lists them.");
  }
  if (!scan->job.pose_of) {
    restore_with_poses(*scan);
    return;
  }
  if (const auto first = bin_.find(scan->job.pose_of->scan)) {
    restore_with_poses(*first);
  }
  if (bin_.find(id)) {
    move_from_bin(*scan);
    rejoin(scan->job);
  }
}

/// Moves a scan out of the bin, with the poses that were deleted with it. `writing_` is held.
void ScanStore::restore_with_poses(const BinnedScan& first) {
  move_from_bin(first);
  for (const BinnedScan& other : bin_.list()) {
    if (other.job.pose_of && other.job.pose_of->scan == first.job.id &&
        !other.job.pose_of->removed_build) {
      move_from_bin(other);
    }
  }
}

void ScanStore::empty_bin() {
  const std::lock_guard writing(writing_);
  for (const BinnedScan& scan : bin_.list()) {
    bin_.remove(scan.job.id);
  }
}

void ScanStore::make_room(std::uint64_t needed, const std::string& what) {
  const std::lock_guard writing(writing_);
  const std::uint64_t free = free_bytes();
  if (free < needed) {
    for (const std::string& id : bin_.oldest(needed - free)) {
      log::info("store", std::string("scan ")
                             .append(id)
                             .append(" leaves the bin: its space is needed for ")
                             .append(what));
      bin_.remove(id);
    }
  }
  expect_room(data_, free_bytes(), needed, what);
}

/// Completes moves that a power cut interrupted: poses follow their scan into the bin, or out of
/// it. A pose that was being removed from its scan, or was returning to it, joins it again. Removes
/// expired scans.
void ScanStore::finish_discards() {
  try {
    for (const Job& job : list()) {
      if (job.pose_of && !find(job.pose_of->scan) && bin_.find(job.pose_of->scan)) {
        move_to_bin(job);
      } else if (job.pose_of) {
        rejoin(job);
      }
    }
    for (const BinnedScan& scan : bin_.list()) {
      if (scan.job.pose_of && !scan.job.pose_of->removed_build && find(scan.job.pose_of->scan)) {
        move_from_bin(scan);
      }
    }
    expire_bin();
  } catch (const Error& error) {
    log::warning("store", error.what());  // a full or read-only disk: the next start tries again
  }
}

std::vector<Job> ScanStore::poses(std::string_view id) const {
  const std::lock_guard lock(mutex_);
  std::vector<Job> poses;
  for (const auto& [other, job] : jobs_) {
    if (job.pose_of && job.pose_of->scan == id) {
      poses.push_back(job);
    }
  }
  std::ranges::reverse(poses);  // `jobs_` is in order of time, newest first
  return poses;
}

fs::path ScanStore::merged_scan(std::string_view id, const std::vector<std::string>& poses) const {
  if (poses.empty()) {
    return folder(id);
  }
  for (const Build& build : get(id).builds.all) {
    auto merged = model_file(id, build.number).parent_path() / merged_folder;
    std::error_code unreadable;
    if (build.poses == poses && fs::is_directory(merged, unreadable)) {
      return merged;
    }
  }
  throw Error(ErrorCode::no_model, "the merged poses of this scan are gone",
              "Choose the model as scanned.");
}

void ScanStore::withdraw_pose(std::string_view id, const std::string& pose) {
  const Job job = get(id);
  if (has_chosen_pose(job, pose)) {
    choose_build(id, build_before(job, pose));
  }
  for (const Build& build : job.builds.all) {
    if (has_pose(build, pose)) {
      remove_build(id, build.number);
    }
  }
}

/// Marks the pose first: until it is in the bin, the next start undoes what a power cut
/// interrupted.
void ScanStore::discard_pose(const std::string& id) {
  const Job first = get(get(id).pose_of.value().scan);
  const bool is_chosen = has_chosen_pose(first, id);
  const Job pose = update(
      id, [&](Job& job) { job.pose_of->removed_build = is_chosen ? first.builds.chosen : 0; });
  if (is_chosen) {
    choose_build(first.id, build_before(first, id));
  }
  const std::lock_guard writing(writing_);
  move_builds_out(first, id);
  move_to_bin(pose);
}

/// Moves the builds that merge a pose into the pose's folder. `writing_` is held.
void ScanStore::move_builds_out(const Job& first, const std::string& pose) {
  const fs::path builds = folder(first.id) / builds_folder;
  const fs::path removed = folder(pose) / removed_builds_folder;
  for (const Build& build : first.builds.all) {
    const std::string name = std::to_string(build.number);
    if (!has_pose(build, pose) || !is_there(builds / name)) {
      continue;
    }
    make_folder(removed);
    move_folder(builds / name, removed / name);
    sync_folder(removed);
    sync_folder(builds);
  }
  const std::lock_guard lock(mutex_);
  std::erase_if(jobs_.find(first.id)->second.builds.all,
                [&](const Build& build) { return has_pose(build, pose); });
  ++revision_;
}

/// Moves the builds of a removed pose back to its scan. A build whose number was given to another
/// one meanwhile gets the next. `writing_` is held.
/// @return the number of the one that was chosen; 0 if there is none
int ScanStore::move_builds_back(const Job& pose) {
  const fs::path removed = folder(pose.id) / removed_builds_folder;
  const fs::path scan = folder(pose.pose_of->scan);
  const fs::path builds = scan / builds_folder;
  int chosen = *pose.pose_of->removed_build;
  for (const std::string& name : names_in(removed)) {
    const int number = to_build_number(name);
    if (number == 0) {
      continue;
    }
    make_folder(builds);
    const int free = is_there(builds / name) ? next_build_number(scan) : number;
    move_folder(removed / name, builds / std::to_string(free));
    sync_folder(builds);
    sync_folder(removed);
    if (number == *pose.pose_of->removed_build) {
      chosen = free;
    }
  }
  std::error_code ignored;  // an empty folder does no harm
  fs::remove(removed, ignored);
  std::vector<Build> all = read_builds(scan);
  const std::lock_guard lock(mutex_);
  jobs_.find(pose.pose_of->scan)->second.builds.all = std::move(all);
  ++revision_;
  return chosen;
}

/// Joins a removed pose with its scan again, if that exists; other poses stay as they are.
/// `writing_` is held, or no other thread has this store yet.
void ScanStore::rejoin(const Job& pose) {
  if (!pose.pose_of->removed_build) {
    return;
  }
  if (find(pose.pose_of->scan)) {
    const int number = move_builds_back(pose);
    Job first = get(pose.pose_of->scan);
    const Build* const before = find_build(first, first.builds.chosen);
    const Build* const build = find_build(first, number);
    std::vector<std::string> poses = before ? before->poses : std::vector<std::string>{};
    poses.push_back(pose.id);
    if (build != nullptr && build->poses == poses) {
      first.builds.chosen = number;
      keep(first);
    }
  }
  Job joined = pose;
  joined.pose_of->removed_build.reset();
  keep(joined);
}

int ScanStore::next_build(std::string_view id) const {
  get(id);  // throws if there is no such scan
  return next_build_number(folder(id));
}

fs::path ScanStore::begin_build(std::string_view id, int number) {
  get(id);  // throws if there is no such scan
  make_room(max_model_bytes(), "a model");
  const fs::path beginning = unfinished_in(folder(id) / builds_folder, number);
  make_folder(beginning);
  return beginning / "Scan.stl";
}

void ScanStore::add_build(std::string_view id, const Build& build) {
  const std::lock_guard writing(writing_);
  get(id);  // throws if there is no such scan
  const fs::path builds = folder(id) / builds_folder;
  const fs::path beginning = unfinished_in(builds, build.number);
  const fs::path kept = builds / std::to_string(build.number);
  write_build(beginning, build);
  std::error_code error;
  fs::rename(beginning, kept, error);
  if (error) {
    throw_data_error(kept, "make the folder", error);
  }
  sync_folder(builds);
  sync_folder(folder(id));  // may have a new entry, `builds`
  const std::lock_guard lock(mutex_);
  jobs_.find(id)->second.builds.all.push_back(build);
  ++revision_;
}

fs::path ScanStore::reserve_build(BuildRun& run) {
  make_room(max_model_bytes(), "a model");
  const std::lock_guard writing(writing_);
  run.number = next_build(run.scan);
  fs::path kept = model_file(run.scan, run.number).parent_path();
  make_folder(kept);
  return kept;
}

void ScanStore::take_build(std::string_view id, int number) {
  const std::lock_guard writing(writing_);
  const Job job = get(id);
  if (find_build(job, number) != nullptr) {
    return;  // finished while no daemon ran, and read at its start
  }
  Build build = read_build(model_file(id, number).parent_path(), number);
  const std::lock_guard lock(mutex_);
  jobs_.find(id)->second.builds.all.push_back(std::move(build));
  ++revision_;
}

void ScanStore::release_build(std::string_view id, int number) {
  const fs::path builds = folder(id) / builds_folder;
  std::error_code ignored;  // the next start removes leftovers
  fs::rename(builds / std::to_string(number), leaving_in(builds, number), ignored);
  fs::remove_all(leaving_in(builds, number), ignored);
}

void ScanStore::drop_build(std::string_view id, int number) {
  std::error_code ignored;  // the next start removes leftovers
  fs::remove_all(unfinished_in(folder(id) / builds_folder, number), ignored);
}

void ScanStore::choose_build(std::string_view id, int number) {
  update(id, [&](Job& job) {
    if (number == 0 ? !job.model : find_build(job, number) == nullptr) {
      throw_no_such_build(number);
    }
    job.builds.chosen = number;
  });
}

void ScanStore::remove_build(std::string_view id, int number) {
  const fs::path builds = folder(id) / builds_folder;
  const fs::path leaving = leaving_in(builds, number);
  std::error_code error;
  {
    const std::lock_guard writing(writing_);
    const Job job = get(id);
    if (number == 0 || job.builds.chosen == number) {
      throw Error(ErrorCode::busy,
                  number == 0 ? "this model belongs to the scan" : "this is the scan's model",
                  number == 0 ? "It goes with the scan." : "Choose another one first.");
    }
    if (find_build(job, number) == nullptr) {
      throw_no_such_build(number);
    }
    // Renamed first, so that a partly removed build is never listed.
    fs::rename(builds / std::to_string(number), leaving, error);
    if (error && error != std::errc::no_such_file_or_directory) {
      throw_data_error(builds / std::to_string(number), "remove", error);
    }
    const std::lock_guard lock(mutex_);
    std::erase_if(jobs_.find(id)->second.builds.all,
                  [&](const Build& build) { return build.number == number; });
    ++revision_;
  }
  fs::remove_all(leaving, error);
  if (error) {
    log::warning("store", leaving.string() + ": cannot remove: " + error.message());
  }
}

fs::path ScanStore::model_file(std::string_view id) const {
  const std::optional<Job> job = find(id);
  return model_file(id, job && find_build(*job, job->builds.chosen) ? job->builds.chosen : 0);
}

fs::path ScanStore::model_file(std::string_view id, int build) const {
  return build == 0 ? folder(id) / "Scan.stl"
                    : folder(id) / builds_folder / std::to_string(build) / "Scan.stl";
}

fs::path ScanStore::begin_import() {
  for (int attempt = 0;; ++attempt) {
    fs::path folder = scans_ / (std::string(unfinished_import) + std::to_string(attempt));
    std::error_code error;
    if (fs::create_directory(folder, error)) {
      return folder;
    }
    if (error) {
      throw_data_error(folder, "make the folder", error);
    }
  }
}

Job ScanStore::adopt(const fs::path& beginning) {
  const Scan scan = read_scan(beginning);
  if (has_free_poses(scan)) {
    throw Error(
        ErrorCode::bad_request,
        "this scan has free poses: it has no platform, and the page has no view of spaces",
        "Unpack the archive, and make its model with: octurn reconstruct FOLDER -o Scan.stl");
  }
  Job job = to_waiting(read_adopted_job(beginning, scan), beginning, scan);
  const std::lock_guard writing(writing_);
  const ScanTime now = next_time();
  job.id = to_scan_id(now);
  if (job.times.created.empty()) {
    job.times.created = utc_text(now, rfc3339);
  }
  expect_readable(job);
  enter(beginning, job);
  return job;
}

double ScanStore::platform_angle_deg() const {
  try {
    const json document =
        parse_json(read_regular_file(platform_, max_platform_bytes).value_or("{}"),
                   ErrorCode::platform_malformed, platform_.string());
    return JsonObject(document, ErrorCode::platform_malformed, "")
        .number("angle_deg", -unlimited, unlimited)
        .value_or(0);
  } catch (const Error& error) {
    log::warning("store", error.what());
    return 0;  // the angle before the first move
  }
}

void ScanStore::save_platform_angle_deg(double angle_deg) const {
  write_file(platform_, json{{"angle_deg", angle_deg}}.dump() + "\n");
}

}  // namespace octurn
