// ScanStore: import of scans from another Octurn.

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/tiles.hpp"
#include "scan/job_file.hpp"
#include "scan/scan_label.hpp"
#include "scan/scan_store.hpp"
#include "scan/stored_scan.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view unfinished_import = ".new-import-";

/// Reads the job of an imported scan; default settings if the folder has no `job.json`. Invalid
/// labels are dropped.
Job read_adopted_job(const fs::path& folder, const Scan& scan) {
  const auto text = read_regular_file(folder / "job.json", max_job_bytes);
  Job job = text ? to_job(parse_json(*text, ErrorCode::bad_request, "job.json")) : Job{};
  if (!text && scan.laser) {
    use_laser_defaults(job.settings);
  }
  job.label = read_label(folder);
  if (!is_name(job.label.name)) {
    job.label.name.clear();
  }
  if (!is_notes(job.label.notes)) {
    job.label.notes.clear();
  }
  return job;
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
  enter(beginning, job);
  return job;
}

}  // namespace octurn
