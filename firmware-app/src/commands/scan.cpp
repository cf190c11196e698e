#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "commands/commands.hpp"
#include "interruption.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "progress_bar.hpp"
#include "scan/scanner.hpp"
#include "sensor/depth_sensor.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// The settings given, as the body of a start would have them: one place checks both.
json json_of(const SettingsArguments& given) {
  json body = json::object();
  const auto add = [&](const char* key, const auto& value) {
    if (value) {
      body[key] = *value;
    }
  };
  add("method", given.method);
  add("max_error_mm", given.max_error_mm);
  add("snapshots", given.snapshots);
  add("filter", given.filter);
  add("frames", given.frames);
  add("leaf_size_mm", given.leaf_size_mm);
  add("threshold_m2", given.threshold_m2);
  add("root_size_mm", given.root_size_mm);
  add("clip_mm", given.clip_mm);
  return body;
}

/// Shows progress until the scan has ended; a signal cancels it.
Job follow(Scanner& scanner, const Job& job, const std::stop_token& stop) {
  using namespace std::chrono_literals;
  ProgressBar bar;
  Status status = scanner.status();
  while (status.busy()) {
    bar.show(status.job->snapshots_done, job.settings.snapshots,
             status.job->failure ? "trying again" : name_of(status.job->phase));
    if (stop.stop_requested()) {
      scanner.cancel(job.id);
    }
    status = scanner.wait_until_done(100ms);
  }
  return *status.job;
}

/// Says why there is no model, where the snapshots are, and how to go on.
[[noreturn]] void explain(const Job& job, const std::filesystem::path& folder) {
  const std::string kept = std::to_string(job.snapshots_done) + " of " +
                           std::to_string(job.settings.snapshots) + " snapshots are in " +
                           folder.string();
  if (!job.failure) {
    throw_stopped(kept);
  }
  const std::string resume =
      is_resumable(job.state) ? " The same command does that with --resume " + job.id : "";
  throw Error(job.failure->code, job.failure->detail + ": " + kept, job.failure->hint + resume);
}

void copy_model(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::ifstream source(from, std::ios::binary);
  AtomicFile target(to);
  std::vector<char> buffer(std::size_t{1} << 20U);
  while (source.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) ||
         source.gcount() > 0) {
    target.write(
        std::as_bytes(std::span(buffer.data(), static_cast<std::size_t>(source.gcount()))));
  }
  if (source.bad()) {
    throw Error("read-failed", from.string() + ": cannot be read");
  }
  target.commit();
}

}  // namespace

void scan(const ScanArguments& arguments) {
  const Config config = chosen_config(arguments.config_file);
  const ScanSettings settings = settings_from(json_of(arguments.settings), config.scan);
  const RigOptions rig = rig_options(arguments.rig, config.turntable);
  load_sensor_drivers();  // before the first thread, as it asks

  const Interruption interruption;
  const ScanStore store(arguments.data.value_or(config.data));
  Scanner scanner(rig, config.limits, store);

  scanner.expect_ready();             // or there would be no more than an empty folder
  const std::optional<Job> started =  // nothing else starts scans here
      arguments.resume ? scanner.resume(*arguments.resume) : scanner.start(settings);
  const Job job = follow(scanner, *started, interruption.token());
  if (!job.model) {
    explain(job, store.folder(job.id));
  }
  copy_model(store.model_file(job.id), arguments.output);
}

}  // namespace octurn
