#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "commands/commands.hpp"
#include "commands/model_report.hpp"
#include "commands/options.hpp"
#include "http/scan_json.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "process.hpp"
#include "progress_bar.hpp"
#include "run/scanner.hpp"
#include "sensor/depth_sensor.hpp"
#include "settings/field.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"

namespace octurn {
namespace {

/// Shows progress until the scan has ended; a signal cancels it.
Job follow(Scanner& scanner, const Job& job, const std::stop_token& stop) {
  using namespace std::chrono_literals;
  ProgressBar bar;
  Status status = scanner.status();
  while (status.busy()) {
    bar.show(status.job->snapshots_done, job.settings.snapshots,
             status.job->failure ? "trying again" : to_string(status.job->phase));
    if (stop.stop_requested()) {
      scanner.cancel(job.id);
    }
    status = scanner.wait_until_done(100ms);
  }
  return *status.job;
}

/// Throws the Error of a scan without a model: why, where its snapshots are, and how to resume it.
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

/// Reads a file in blocks of 1 MiB.
template <typename Sink>
void read_parts(const std::filesystem::path& file, const Sink& sink) {
  std::ifstream source(file, std::ios::binary);
  std::vector<char> buffer(std::size_t{1} << 20U);
  while (source.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) ||
         source.gcount() > 0) {
    sink(std::as_bytes(std::span(buffer.data(), static_cast<std::size_t>(source.gcount()))));
  }
  if (source.bad()) {
    throw Error(ErrorCode::read_failed, file.string() + ": cannot be read");
  }
}

void copy_model(const std::filesystem::path& from, const std::filesystem::path& to) {
  if (to == "-") {
    read_parts(from, [](std::span<const std::byte> bytes) { write_standard_output(bytes); });
    return;
  }
  AtomicFile target(to);
  read_parts(from, [&](std::span<const std::byte> bytes) { target.write(bytes); });
  target.commit();
}

/// Copies the model; the Error of a failure says where the model is kept.
void hand_over_model(const std::filesystem::path& from, const std::filesystem::path& to) {
  try {
    copy_model(from, to);
  } catch (const Error& error) {
    throw Error(error.code(), std::string(error.what()) + ": the model is " + from.string(),
                error.hint());
  }
}

/// Checks that the scan is in the store.
const std::string& known_id(const std::string& given, const ScanStore& store) {
  if (!store.find(given)) {
    const std::string scans = (store.data() / "scans").string();
    throw Error(ErrorCode::no_such_scan, given + ": is no scan in " + scans,
                "ls " + scans + " lists them.");
  }
  return given;
}

/// Converts the folder of a scan in the store to the scan's id; an id stays as it is.
std::string to_id(const std::string& given, const ScanStore& store) {
  if (store.find(given) || !std::filesystem::is_directory(given)) {
    return known_id(given, store);
  }
  const auto folder = std::filesystem::canonical(given);
  std::string id = folder.filename();
  if (!store.find(id) || std::filesystem::canonical(store.folder(id)) != folder) {
    throw Error(ErrorCode::no_such_scan,
                given + ": is no scan in " + store.data().string() +
                    ", and the model of both poses is kept with a scan there",
                "Scan the object as it lies now without --pose-of, and join the two folders with "
                "octurn merge.");
  }
  return id;
}

/// The arguments' settings; those that they leave out are the first scan's.
ScanSettings pose_settings(const ScanArguments& arguments, const Job& first,
                           const Scanner& scanner) {
  ScanSettings settings =
      settings_from(arguments.settings, scanner.calibration().in_force(first.settings));
  settings.depth_scale = first.settings.depth_scale;  // the scans are merged: they need one scale
  return settings;
}

/// The scan that the arguments resume, or that they add a pose to; empty for a new one.
std::string earlier_scan(const ScanArguments& arguments, const ScanStore& store) {
  return arguments.resume    ? known_id(*arguments.resume, store)
         : arguments.pose_of ? to_id(*arguments.pose_of, store)
                             : std::string();
}

/// Starts or resumes the scan.
/// @param earlier   as `earlier_scan` says
/// @param settings  for a scan that is neither resumed nor of a pose
std::optional<Job> begin(const ScanArguments& arguments, const std::string& earlier,
                         const ScanSettings& settings, const ScanStore& store, Scanner& scanner) {
  if (arguments.resume) {
    return scanner.resume(earlier);
  }
  if (arguments.pose_of) {
    return scanner.start_pose(earlier, pose_settings(arguments, store.get(earlier), scanner));
  }
  return scanner.start(scanner.calibration().in_force(settings));
}

/// The id of the scan that has the model. A scan of another pose is merged into its first scan.
/// @throws Error "no-model"  if the pose could not be registered
std::string scan_with_model(const Job& job, const ScanStore& store) {
  if (!job.pose_of) {
    return job.id;
  }
  const auto& registration = job.pose_of->registration;
  if (registration && !registration->accepted) {
    throw Error(ErrorCode::no_model, "not merged: " + registration->reason,
                "The scan before it is as it was; this one is in " + store.folder(job.id).string());
  }
  return job.pose_of->scan;
}

}  // namespace

void scan(const ScanArguments& arguments) {
  const Config config = make_config(arguments.config);
  ScanSettings settings = settings_from(arguments.settings, config.scan);
  expect_options_of_method(arguments.settings, fields(settings), to_string(settings.method));
  expect_writable(arguments.output);  // before minutes of scanning
  const RigOptions rig = rig_options(arguments.rig, config);
  load_sensor_drivers();  // changes the working directory: before the first thread

  const SignalStop signal;
  ScanStore store(config.data);
  const std::string earlier = earlier_scan(arguments, store);  // before the devices are opened
  return_freed_memory();
  Scanner scanner(rig, config.limits, store);

  scanner.expect_ready();  // a missing device would leave an empty scan folder
  const std::optional<Job> started =
      begin(arguments, earlier, settings, store, scanner);  // has a value: no other scan runs
  const Job job = follow(scanner, *started, signal.token());
  if (job.state != JobState::finished) {
    explain(job, store.folder(job.id));
  }
  const Job whole = store.get(scan_with_model(job, store));
  hand_over_model(store.model_file(whole.id), arguments.output);
  if (const Model* model = chosen_model(whole); model != nullptr && model->quality) {
    print_verdict(*model->quality);
    if (model->quality->size_error) {
      print_size_error(*model->quality->size_error);
    }
  }
  if (arguments.json) {
    print_report(arguments.output, to_json(whole).dump());
  }
}

}  // namespace octurn
