#include "scan/scan_store.hpp"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <nlohmann/json.hpp>
#include <ratio>
#include <system_error>
#include <utility>

#include "log.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/units.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// Date and time of day (UTC), and how far into the second, in steps of 20 us. So ids sort by time.
constexpr std::string_view id_form = "00000000-000000-xxxx";
using Moment = std::chrono::sys_time<std::chrono::duration<std::int64_t, std::ratio<1, 50000>>>;

// Folders in the making, and on their way out, begin with a dot: they are not listed, and the next
// start clears them away.
constexpr std::string_view unfinished = ".new-";
constexpr std::string_view removed = ".removed-";

constexpr const char* lock_file = "lock";

constexpr double most = std::numeric_limits<double>::max();

constexpr std::size_t max_job_bytes = std::size_t{1} << 20U;  // a hundred times what is written
constexpr std::size_t max_name_bytes = 4096;
constexpr std::size_t max_platform_bytes = 4096;

// A 16-bit depth image that does not compress at all, and a fine model.
constexpr std::uint64_t snapshot_bytes = std::uint64_t{640} * 480 * 2;
constexpr std::uint64_t model_bytes = std::uint64_t{128} << 20U;

std::string id_of(Moment moment) {
  auto fraction = (moment - std::chrono::floor<std::chrono::seconds>(moment)).count();
  std::string digits(4, '0');
  for (auto digit = digits.rbegin(); digit != digits.rend(); ++digit, fraction >>= 4) {
    *digit = "0123456789abcdef"[fraction & 0xf];
  }
  return utc_text(moment, "%Y%m%d-%H%M%S-") + digits;
}

Moment moment_of(const std::string& id) {
  std::tm utc{};
  const char* const fraction = ::strptime(id.c_str(), "%Y%m%d-%H%M%S-", &utc);
  return Moment(std::chrono::seconds(::timegm(&utc))) +
         Moment::duration(fraction == nullptr ? 0 : std::strtol(fraction, nullptr, 16));
}

[[noreturn]] void fail(const fs::path& path, const std::string& doing, std::error_code reason) {
  const bool full = reason == std::errc::no_space_on_device;
  throw Error(
      full ? "disk-full" : "data-failed",
      path.string() + ": cannot " + doing + ": " + reason.message(),
      full ? "Delete scans that are no longer needed."
           : "Check that this program may write there, or choose another folder with --data.");
}

/// The names in a folder; those that could be read, if the disk fails meanwhile.
std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  fs::directory_iterator entry(folder, error);
  while (!error && entry != fs::directory_iterator()) {
    names.push_back(entry->path().filename().string());
    entry.increment(error);
  }
  return names;
}

/// Removes what begins with a dot: temporary files, and folders that were not finished.
void clear_unfinished(const fs::path& folder) {
  std::error_code ignored;  // what cannot be cleared away does no harm
  for (const std::string& name : names_in(folder)) {
    if (name.starts_with('.')) {
      fs::remove_all(folder / name, ignored);
    }
  }
}

int stored_snapshots(const fs::path& folder) {
  try {
    return static_cast<int>(read_scan(folder).shots.size());
  } catch (const std::exception&) {
    return 0;  // it ended before the first snapshot, which writes the first scan.json
  }
}

/// As `job.json` has it. Names and messages may hold bytes that are no UTF-8: those are replaced.
std::string text_of(const Job& job) {
  return json_of(job).dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

/// @throws Error "job-malformed", "read-failed"
Job read_job(const fs::path& folder) {
  return job_from(parse_json(read_regular_file(folder / "job.json", max_job_bytes).value_or(""),
                             "job-malformed", "the file"));
}

/// What a person called a scan; empty if that cannot be read, as the scan itself can be.
std::string read_name(const fs::path& folder) {
  try {
    return read_regular_file(folder / "name.txt", max_name_bytes).value_or("");
  } catch (const Error&) {
    return "";
  }
}

}  // namespace

bool is_scan_id(std::string_view text) {
  return std::ranges::equal(text, id_form, [](char c, char form) {
    const bool digit = c >= '0' && c <= '9';
    return form == '0' ? digit : form == 'x' ? digit || (c >= 'a' && c <= 'f') : c == form;
  });
}

std::uint64_t most_bytes_of(const ScanSettings& settings) {
  return model_bytes + snapshot_bytes * static_cast<std::uint64_t>(settings.snapshots);
}

fs::path existing_part(fs::path folder) {
  std::error_code ignored;
  while (!folder.empty() && !fs::exists(folder, ignored) && folder != folder.parent_path()) {
    folder = folder.parent_path();
  }
  return folder.empty() ? fs::path(".") : folder;
}

std::uint64_t free_bytes_in(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(existing_part(folder), error);
  if (error) {
    fail(folder, "read", error);
  }
  return space.available;
}

bool is_in_use(const fs::path& data) {
  const FileDescriptor lock(::open((data / lock_file).c_str(), O_RDONLY | O_CLOEXEC));
  return lock.is_open() && ::flock(lock.number(), LOCK_SH | LOCK_NB) != 0;
}

ScanStore::ScanStore(fs::path data)
    : data_(std::move(data)), scans_(data_ / "scans"), platform_(data_ / "platform.json") {
  std::error_code error;
  fs::create_directories(scans_, error);
  if (error) {
    fail(scans_, "make the folder", error);
  }
  const fs::path file = data_ / lock_file;
  lock_ = FileDescriptor(::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (!lock_.is_open()) {
    fail(file, "open", {errno, std::generic_category()});
  }
  if (::flock(lock_.number(), LOCK_EX | LOCK_NB) != 0) {
    throw Error("data-in-use", data_.string() + ": another octurn works in this folder",
                "End it first, or choose another folder with --data.");
  }
  recover();
}

Job ScanStore::create(const ScanSettings& settings) const {
  const std::uint64_t needed = most_bytes_of(settings);
  if (const std::uint64_t available = free_bytes(); available < needed) {
    const auto mb = [](std::uint64_t bytes) {
      return std::to_string(static_cast<int>(mb_from_bytes(static_cast<double>(bytes)))) + " MB";
    };
    throw Error("disk-full",
                mb(available) + " free in " + data_.string() + ", a scan of " +
                    std::to_string(settings.snapshots) + " snapshots needs " + mb(needed),
                "Delete scans that are no longer needed.");
  }
  // A Pi has no clock of its own: after a power cut the time may have gone back.
  auto now = std::chrono::floor<Moment::duration>(std::chrono::system_clock::now());
  if (const std::vector<std::string> ids = ids_newest_first(); !ids.empty()) {
    now = std::max(now, moment_of(ids.front()) + Moment::duration(1));
  }
  Job job{.id = id_of(now), .created = utc_text(now, rfc3339), .settings = settings};

  const fs::path beginning = scans_ / (std::string(unfinished) + job.id);
  std::error_code error;
  fs::create_directory(beginning, error);
  if (error) {
    fail(beginning, "make the folder", error);
  }
  write_file(beginning / "job.json", text_of(job));
  fs::rename(beginning, folder(job.id), error);
  if (error) {
    fail(folder(job.id), "make the folder", error);
  }
  sync_folder(scans_);
  return job;
}

void ScanStore::save(const Job& job) const {
  write_file(folder(job.id) / "job.json", text_of(job));
}

std::vector<Job> ScanStore::list() const {
  std::vector<Job> jobs;
  for (const std::string& id : ids_newest_first()) {
    if (auto job = find(id)) {
      jobs.push_back(*std::move(job));
    }
  }
  return jobs;
}

std::optional<Job> ScanStore::find(std::string_view id) const {
  std::error_code unknown;
  if (!is_scan_id(id) || !fs::is_directory(folder(id), unknown)) {
    return std::nullopt;
  }
  Job job;
  try {
    job = read_job(folder(id));
  } catch (const std::exception& error) {
    job = {};
    job.state = JobState::failed;
    job.phase = Phase::done;
    job.failure =
        Failure{.code = current_failure().code == "read-failed" ? "read-failed" : "job-malformed",
                .detail = std::string("job.json: ") + error.what(),
                .hint = "Its snapshots may still be good; octurn reconstruct reads them."};
  }
  job.id = id;
  job.name = read_name(folder(id));
  return job;
}

std::optional<Job> ScanStore::newest_finished() const {
  for (const std::string& id : ids_newest_first()) {
    if (auto job = find(id); job && job->state == JobState::finished) {
      return job;
    }
  }
  return std::nullopt;
}

void ScanStore::rename(std::string_view id, std::string_view name) const {
  if (!find(id)) {
    throw Error("no-such-scan", "there is no scan " + std::string(id));
  }
  write_file(folder(id) / "name.txt", name);
}

void ScanStore::remove(std::string_view id) const {
  if (!find(id)) {
    throw Error("no-such-scan", "there is no scan " + std::string(id));
  }
  // Renamed first: a scan that is half removed is never seen.
  const fs::path leaving = scans_ / (std::string(removed) + std::string(id));
  std::error_code error;
  fs::rename(folder(id), leaving, error);
  if (error) {
    fail(folder(id), "remove", error);
  }
  fs::remove_all(leaving, error);
  if (error) {
    log::warning("store", leaving.string() + ": cannot remove: " + error.message());
  }
}

fs::path ScanStore::folder(std::string_view id) const { return scans_ / id; }

double ScanStore::platform_angle_deg() const {
  try {
    const json document =
        parse_json(read_regular_file(platform_, max_platform_bytes).value_or("{}"),
                   "platform-malformed", platform_.string());
    return JsonObject(document, "platform-malformed", "")
        .number("angle_deg", -most, most)
        .value_or(0);
  } catch (const Error& error) {
    log::warning("store", error.what());
    return 0;  // as before the first move
  }
}

void ScanStore::save_platform_angle_deg(double angle_deg) const {
  write_file(platform_, json{{"angle_deg", angle_deg}}.dump() + "\n");
}

std::uint64_t ScanStore::free_bytes() const { return free_bytes_in(scans_); }

std::vector<std::string> ScanStore::ids_newest_first() const {
  std::vector<std::string> ids;
  for (std::string& name : names_in(scans_)) {
    if (is_scan_id(name)) {
      ids.push_back(std::move(name));
    }
  }
  std::ranges::sort(ids, std::ranges::greater());  // they begin with the time
  return ids;
}

void ScanStore::recover() const {
  clear_unfinished(scans_);
  for (Job& job : list()) {
    if (job.state != JobState::running) {
      continue;
    }
    clear_unfinished(folder(job.id));
    clear_unfinished(folder(job.id) / "snapshots");
    job.state = JobState::interrupted;
    job.phase = Phase::done;
    job.snapshots_done = stored_snapshots(folder(job.id));
    job.failure = interruption();
    log::info("store", "scan " + job.id + " was interrupted after " +
                           std::to_string(job.snapshots_done) + " snapshots");
    try {
      save(job);
    } catch (const Error& error) {
      // A full disk: the API calls the scan interrupted all the same, and the page can delete it.
      log::warning("store", error.what());
    }
  }
}

}  // namespace octurn
