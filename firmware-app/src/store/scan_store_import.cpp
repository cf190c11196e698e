// ScanStore: import of scans from another Octurn.

#include <chrono>
#include <cstddef>
#include <string>
#include <system_error>

#include "octurn/error.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/tiles.hpp"
#include "store/job_file.hpp"
#include "store/scan_label.hpp"
#include "store/scan_store.hpp"
#include "store/stored_scan.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view unfinished_import = ".new-import-";
constexpr std::size_t max_adopted_bytes = max_job_bytes / 2;  // leaves room for the model
constexpr std::size_t max_created = 40;  // characters; "2026-11-21T08:15:00Z" has 20

/// Reads a label, and removes the files of what cannot be one.
ScanLabel read_adopted_label(const fs::path& folder) {
  const ScanLabel found = read_label(folder);
  LabelChange change;
  if (!is_name(found.name)) {
    change.name = "";
  }
  if (!is_notes(found.notes)) {
    change.notes = "";
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
  return job;
}

}  // namespace

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

}  // namespace octurn
