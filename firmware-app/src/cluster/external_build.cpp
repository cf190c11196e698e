#include "cluster/external_build.hpp"

#include <chrono>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>

#include "build/build_model.hpp"
#include "log.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "store/builds.hpp"
#include "store/data_folder.hpp"
#include "store/job_json.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr const char* build_file = "build.json";
constexpr const char* failure_file = "failure.json";
constexpr const char* progress_file = "progress.json";
constexpr std::size_t max_exchanged_file_bytes = std::size_t{64} << 10U;
constexpr auto progress_interval = std::chrono::seconds(1);  // minimum time between two writes

/// Writes a build's progress for the process that waits for it. Thread-safe.
class ProgressFile {
 public:
  explicit ProgressFile(fs::path folder) : file_(std::move(folder) / progress_file) {}

  void show(Phase phase, int done) {
    const std::lock_guard lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (phase == phase_ && now - written_ < progress_interval) {
      return;
    }
    phase_ = phase;
    written_ = now;
    write_file(file_, json{{"phase", to_string(phase)}, {"snapshots_done", done}}.dump() + "\n");
  }

 private:
  fs::path file_;
  std::mutex mutex_;  // guards the members below
  std::optional<Phase> phase_ = {};
  Clock::time_point written_ = {};
};

/// Reads a JSON file; nullopt if it is missing or unreadable.
std::optional<json> read_json(const fs::path& file) {
  try {
    if (const auto text = read_regular_file(file, max_exchanged_file_bytes)) {
      return parse_json(*text, ErrorCode::job_malformed, file.filename().string());
    }
  } catch (const Error& error) {
    log::warning("build", file.string() + ": " + error.what());
  }
  return std::nullopt;
}

}  // namespace

bool build_task_in(const fs::path& folder, const std::stop_token& stop) {
  std::error_code ignored;
  fs::remove(folder / failure_file, ignored);  // of an earlier attempt
  try {
    const auto [task, limits] = read_task(folder);
    ProgressFile progress(folder);
    const auto build = build_model(task, limits, folder / "Scan.stl", stop,
                                   [&](Phase phase, int done) { progress.show(phase, done); });
    if (build) {
      write_build(folder, *build);
    }
    return build.has_value();
  } catch (...) {
    const Failure failure = current_failure();
    write_file(folder / failure_file,
               to_json(failure).dump(-1, ' ', false, json::error_handler_t::replace) + "\n");
    throw;
  }
}

bool is_built(const fs::path& folder) {
  std::error_code unknown;
  return fs::exists(folder / build_file, unknown);
}

std::optional<Failure> read_failure(const fs::path& folder) {
  const std::optional<json> document = read_json(folder / failure_file);
  try {
    return document ? std::optional(to_failure(JsonValue(*document, "", ErrorCode::job_malformed)))
                    : std::nullopt;
  } catch (const Error& error) {
    return to_failure(error);
  }
}

void read_progress(const fs::path& folder, BuildRun& run) {
  const std::optional<json> document = read_json(folder / progress_file);
  if (!document) {
    return;
  }
  try {
    JsonObject keys(*document, ErrorCode::job_malformed, "");
    const auto done = keys.whole_number("snapshots_done", 0, std::numeric_limits<int>::max());
    run.phase = phase_named(keys.text("phase").value_or("")).value_or(run.phase);
    run.snapshots_done = done.value_or(run.snapshots_done);
  } catch (const Error& error) {
    log::warning("build", error.what());
  }
}

void clear_work_files(const fs::path& folder) {
  clear_unfinished(folder);
  std::error_code ignored;  // leftovers are harmless
  for (const std::string& name : names_in(folder)) {
    if (name != "Scan.stl" && name != build_file && name != task_file) {
      fs::remove(folder / name, ignored);
    }
  }
  fs::remove(folder / task_file, ignored);  // last: while it exists, the next start repeats this
}

}  // namespace octurn
