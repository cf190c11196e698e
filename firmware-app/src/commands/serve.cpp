#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
#include <string>
#include <system_error>

#include "appliance/appliance.hpp"
#include "commands/commands.hpp"
#include "http/api.hpp"
#include "http/http_server.hpp"
#include "http/same_origin.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "process.hpp"
#include "run/scanner.hpp"
#include "sensor/depth_sensor.hpp"
#include "signal_stop.hpp"
#include "version.hpp"

namespace octurn {
namespace {

/// Detects a crash loop: a daemon that dies soon after each start, for example in the driver of a
/// broken device. The file `starts` in the data folder counts the starts of this boot of the
/// machine. It is removed when the daemon ends normally, or has run for a minute.
class StartRecord {
 public:
  /// Counts this start, or logs that it is not counted if the folder cannot be written to.
  explicit StartRecord(const std::filesystem::path& data);
  ~StartRecord();
  StartRecord(const StartRecord&) = delete;
  StartRecord& operator=(const StartRecord&) = delete;

  /// Whether at least three starts before this one crashed. The devices should then stay closed.
  bool is_safe_mode() const { return failed_starts_ >= 3; }

  /// Removes the file if a minute has passed since the start.
  void remove_when_stable();

 private:
  void forget();

  std::filesystem::path file_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  int failed_starts_ = 0;
  bool is_kept_ = true;
};

namespace fs = std::filesystem;
using namespace std::chrono_literals;

constexpr auto long_enough = 1min;
constexpr std::size_t max_bytes = 4096;

/// The kernel's id of this boot. Starts of earlier boots do not count: the machine may have lost
/// power, which is no crash of a driver.
std::string read_boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  file >> id;
  return id;
}

/// The number of starts of a boot that the file counts; 0 if it is of another boot.
int read_starts(const fs::path& file, const std::string& boot) {
  std::istringstream text(read_regular_file(file, max_bytes).value_or(""));
  std::string of_boot;
  int starts = 0;
  text >> of_boot >> starts;
  return text && of_boot == boot ? starts : 0;
}

StartRecord::StartRecord(const fs::path& data) : file_(data / "starts") {
  try {
    const std::string boot = read_boot_id();
    failed_starts_ = read_starts(file_, boot);
    write_file(file_, boot + " " + std::to_string(failed_starts_ + 1) + "\n");
  } catch (const Error& error) {
    log::info("octurn", std::string("this start is not counted: ") + error.what());
  }
}

StartRecord::~StartRecord() { forget(); }

void StartRecord::remove_when_stable() {
  if (std::chrono::steady_clock::now() - began_ > long_enough) {
    forget();
  }
}

void StartRecord::forget() {
  if (is_kept_) {
    is_kept_ = false;
    std::error_code ignored;
    fs::remove(file_, ignored);
  }
}

/// URL of the page for a browser on this machine.
std::string page_address(const HttpOptions& options, int port) {
  const bool any = options.address == "0.0.0.0" || options.address == "::";
  const bool v6 = options.address.find(':') != std::string::npos;
  const std::string host = any ? "localhost" : v6 ? "[" + options.address + "]" : options.address;
  return "http://" + host + ":" + std::to_string(port) + "/";
}

/// Why the daemon stops serving.
enum class Outcome { end, restart };

/// A restart for new settings waits at least this long, so that the response to the request that
/// stored them is sent first.
constexpr auto poll_interval = 500ms;

/// The daemon's state that outlives its restarts.
struct Machine {
  const ServeArguments& arguments;
  const Page& page;
  std::optional<Appliance>& appliance;
  StartRecord* start = nullptr;  ///< null on a simulated rig
  int port = 0;                  ///< of the first start; 0 before it
};

/// Objects that live from one restart to the next.
struct Daemon {
  const ConfigStore& settings;
  const Scanner& scanner;
  const TurntableRunner& turntable;
};

/// Whether settings wait for a restart, and nothing runs that a restart would interrupt.
bool is_restart_due(const Machine& machine, const Daemon& daemon) {
  return !daemon.settings.restart_needed().empty() && !daemon.scanner.is_busy() &&
         daemon.turntable.state().doing == TurntableState::Doing::nothing &&
         !(machine.appliance && machine.appliance->is_updating());
}

/// Waits for SIGINT or SIGTERM, or for settings that need a restart. Meanwhile it notifies
/// systemd's watchdog as long as the scanner's worker is alive.
Outcome wait(const Machine& machine, const Daemon& daemon) {
  const auto watchdog = watchdog_interval();
  const std::chrono::microseconds interval =
      watchdog ? std::min<std::chrono::microseconds>(*watchdog / 3, poll_interval) : poll_interval;
  bool was_due = false;
  while (!wait_for_signal(interval)) {
    if (machine.start != nullptr) {
      machine.start->remove_when_stable();
    }
    const bool is_due = is_restart_due(machine, daemon);
    if (is_due && was_due) {
      return Outcome::restart;
    }
    was_due = is_due;
    if (!watchdog) {
      continue;
    }
    if (daemon.scanner.is_alive()) {
      notify_alive();
    } else {
      log::error("octurn", "the scanner's worker has stopped working");
    }
  }
  return Outcome::end;
}

/// Logs the start, notifies systemd, and prints the page's address, at the first start only.
void announce(Machine& machine, const HttpOptions& options, int port) {
  if (machine.port == 0) {
    std::cout << "Octurn is at " << page_address(options, port) << std::endl;
  }
  machine.port = port;
  log::info("octurn", "version " + std::string(version()) + " ready");
  notify_ready("serving the page at port " + std::to_string(port));
}

/// Options of Slurm if it builds the models. Its jobs run this program, which has to have the same
/// path on all machines.
std::optional<SlurmOptions> slurm_options(const ServeArguments& arguments) {
  if (arguments.builds_by != "slurm") {
    return std::nullopt;
  }
  return SlurmOptions{.octurn = std::filesystem::read_symlink("/proc/self/exe")};
}

constexpr Check safe_mode{.id = "safe-mode", .name = "Safe mode"};
constexpr const char* why_safe =
    "Octurn ended three times soon after its start, so sensor and turntable stay closed";
constexpr const char* leave_safe_mode =
    "Take the sensor's plugs out and put them in again, then restart Octurn. Scans and models are "
    "there as ever.";

/// Replaces the rig's functions that open devices by ones that throw the reason of safe mode.
RigOptions closed(RigOptions rig) {
  rig.open_sensor = [](const std::string&) -> std::unique_ptr<DepthSensor> {
    throw Error(ErrorCode::sensor_missing, why_safe, leave_safe_mode);
  };
  rig.open_lines = [](const StepperSettings&) -> Stepper::SetLine {
    throw Error(ErrorCode::turntable_missing, why_safe, leave_safe_mode);
  };
  rig.open_camera = [](const LaserSettings&) -> CameraAndLasers {
    throw Error(ErrorCode::sensor_missing, why_safe, leave_safe_mode);
  };
  return rig;
}

/// Listens where the server before did, unless the settings choose another port.
/// @param port  of the server before; 0: there was none
void keep_port(HttpOptions& options, int port) {
  if (options.port == 0) {
    options.port = port;
  }
  if (port != 0 && options.port == port) {
    options.bind_patience = std::chrono::seconds(10);  // it was this program's until now
  }
}

/// Serves with the settings as they are now, until a signal or until they need a restart.
Outcome serve_once(Machine& machine, ConfigStore& settings) {
  Config config = settings.config();
  keep_port(config.http, machine.port);
  const bool is_safe = machine.start != nullptr && machine.start->is_safe_mode();
  RigOptions rig = rig_options(machine.arguments.rig, config);
  if (is_safe) {
    log::error("octurn", why_safe);
    rig = closed(std::move(rig));
  }
  ScanStore store(config.data);
  Scanner scanner(rig, config.limits, store, slurm_options(machine.arguments));
  TurntableRunner turntable(scanner, store);
  AccessKeys keys(config.data / "keys.json");
  const MachineWatch health({.free_bytes = [&] { return store.free_bytes(); },
                             .warnings =
                                 [&] {
                                   auto found = find_machine_warnings(
                                       doctor_input(rig, settings, scanner.calibration(), store));
                                   if (is_safe) {
                                     found.push_back(safe_mode.fault(why_safe, leave_safe_mode));
                                   }
                                   return found;
                                 }});
  AddressBook addresses(config.data / "addresses.json");
  PrinterUploads uploads;
  Api api({.scanner = scanner,
           .store = store,
           .page = machine.page,
           .settings = settings,
           .turntable = turntable,
           .keys = keys,
           .machine = health,
           .addresses = addresses,
           .uploads = uploads,
           .rig = rig,
           .appliance = machine.appliance ? &*machine.appliance : nullptr});
  const auto gate = [&](const Request& request) {
    return machine.appliance
               ? captive_answer(request, settings.config().host_names, *machine.appliance)
               : std::nullopt;
  };
  const HttpServer server(
      config.http, [&](const Request& request) { return api.answer(request); }, &keys, gate);

  settings.keep_as_good();
  announce(machine, config.http, server.port());
  const Outcome outcome =
      wait(machine, {.settings = settings, .scanner = scanner, .turntable = turntable});
  log::info("octurn", outcome == Outcome::end ? "ending" : "starting again with other settings");
  if (outcome == Outcome::end) {
    notify_stopping();
  }
  api.end_events();
  scanner.request_stop();  // no request shall wait for the scanner while the server ends
  return outcome;
}

/// Whether other settings may help against an error. A full or failing disk and a data folder in
/// use are no fault of the page's settings, which do not choose the folder.
bool may_be_of_settings(ErrorCode code) {
  constexpr std::array of_disk{ErrorCode::data_failed, ErrorCode::data_in_use, ErrorCode::disk_full,
                               ErrorCode::read_failed, ErrorCode::write_failed};
  return std::ranges::find(of_disk, code) == of_disk.end();
}

/// Serves with the current settings. If they fail, serves with the last ones that worked.
Outcome serve_with_good_settings(Machine& machine) {
  ConfigStore settings = open_config(machine.arguments.config);
  if (const std::string trouble = settings.trouble(); !trouble.empty()) {
    log::warning("settings", trouble);
  }
  try {
    return serve_once(machine, settings);
  } catch (const Error& error) {
    if (!may_be_of_settings(error.code()) || !settings.return_to_last_good()) {
      throw;
    }
    log::error("settings", std::string("the page's last settings are undone: ") + error.what());
  }
  return serve_once(machine, settings);
}

}  // namespace

void serve(const ServeArguments& arguments) {
  return_freed_memory();
  std::optional<StartRecord> start;
  if (!arguments.rig.simulate) {
    start.emplace(open_config(arguments.config).config().data);
  }
  if (!start || !start->is_safe_mode()) {
    load_sensor_drivers();  // changes the working directory: before the first thread
  }
  if (const auto slurm = slurm_options(arguments)) {
    slurm->slurm.expect_programs();
  }
  const Page page(arguments.web ? *arguments.web : page_folder());
  std::optional<Appliance> appliance;
  if (arguments.appliance) {
    appliance.emplace(*arguments.appliance);
  }
  Machine machine{.arguments = arguments,
                  .page = page,
                  .appliance = appliance,
                  .start = start ? &*start : nullptr};
  while (serve_with_good_settings(machine) == Outcome::restart) {
  }
}

}  // namespace octurn
