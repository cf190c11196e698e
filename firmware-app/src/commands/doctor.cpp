#include "doctor/doctor.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <sstream>

#include "calibration/calibration_store.hpp"
#include "commands/commands.hpp"
#include "commands/record.hpp"
#include "doctor/diagnostics.hpp"
#include "doctor/turn_checks.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/snapshot.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "zip_file.hpp"

namespace octurn {
namespace {

constexpr std::size_t state_width = std::string_view("warning").size();

/// ANSI escape of a state's colour: green, yellow, red, dim.
std::string_view terminal_colour(Finding::State state) {
  constexpr std::array<std::string_view, 4> colours{"\033[32m", "\033[33m", "\033[31m", "\033[2m"};
  return colours[static_cast<std::size_t>(state)];
}

std::string padded(std::string_view text, std::size_t width) {
  return std::string(text) + std::string(width - std::min(width, text.size()), ' ');
}

std::string state_text(Finding::State state, bool in_colour) {
  const std::string text = padded(to_string(state), state_width);
  return in_colour ? std::string(terminal_colour(state)) + text + "\033[0m" : text;
}

std::string counted(std::ptrdiff_t count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string summary(const std::vector<Finding>& findings) {
  const auto faults = std::ranges::count(findings, Finding::State::fault, &Finding::state);
  const auto warnings = std::ranges::count(findings, Finding::State::warning, &Finding::state);
  return (faults == 0 ? "No fault" : counted(faults, "fault")) +
         (warnings == 0 ? "" : ", " + counted(warnings, "warning")) + ".";
}

std::string table_text(const std::vector<Finding>& findings) {
  std::ostringstream text;
  const bool in_colour = ::isatty(STDOUT_FILENO) == 1;
  std::size_t width = 0;
  for (const Finding& finding : findings) {
    width = std::max(width, finding.name.size());
  }
  for (const Finding& finding : findings) {
    text << state_text(finding.state, in_colour) << "  " << padded(finding.name, width) << "  "
         << finding.measured << '\n';
    if (!finding.advice.empty()) {
      text << std::string(state_width + width + 4, ' ') << finding.advice << '\n';
    }
  }
  text << '\n' << summary(findings) << '\n';
  return text.str();
}

/// How long the wire is recorded for `--zip`: hundreds of frames.
constexpr std::chrono::seconds wire_time{10};

/// Opens and reads the sensor, unless a daemon on this data folder is using it.
SensorReading read_sensor_from_shell(const DoctorInput& input, const std::stop_token& stop) {
  if (input.lines == LineOwner::this_program && input.rig.stepper) {
    return Failure{.code = ErrorCode::busy,
                   .detail = "not checked: the Octurn that is running here is using it",
                   .hint = "Open its page and choose Check the scanner."};
  }
  Rig rig(input.rig);
  return read_sensor(rig, stop);
}

/// What comes from a Kinect over USB. Nothing of another sensor, one that cannot be opened, of
/// which a finding says so, or one that a daemon is using.
std::optional<std::string> record_wire(const DoctorInput& input, const std::stop_token& stop) try {
  if ((input.lines == LineOwner::this_program && input.rig.stepper) || input.rig.laser) {
    return std::nullopt;
  }
  Rig rig(input.rig);
  return usb_log_text(rig.sensor(), wire_time, stop);
} catch (const Error&) {
  return std::nullopt;
}

/// @param settings  in force, without the pose that was measured
std::vector<ArchivedFile> make_diagnostics(const DoctorInput& input, const Config& settings,
                                           std::span<const Finding> findings,
                                           const std::stop_token& stop) {
  std::vector<ArchivedFile> files = machine_diagnostics(input.config, findings);
  files.push_back(calibration_diagnostics(settings));
  files.push_back(scan_diagnostics(settings.data));
  if (std::optional<std::string> wire = record_wire(input, stop)) {
    files.push_back({.name = "wire.txt", .content = *std::move(wire)});
  }
  return files;
}

/// Turns the platform once and checks its motion.
std::vector<Finding> check_motion(const DoctorInput& input, const std::stop_token& stop) {
  constexpr Check turn{"turn", "Turn"};
  if (input.lines == LineOwner::this_program && input.rig.stepper) {
    return {turn.unknown("not made: the Octurn that is running here has the turntable",
                         "Open its page and choose Settings, Turntable.")};
  }
  try {
    Rig rig(input.rig);
    const ScanSettings& scan = input.config.scan;
    std::vector<TurnFinding> turned = test_turn(
        rig, input.config.turntable, scan.platform_from_sensor, scan.clip, stop, [](double) {});
    rig.release_turntable();
    std::vector<Finding> findings;
    for (TurnFinding& one : turned) {
      findings.push_back(std::move(one.finding));
    }
    return findings;
  } catch (const Error& error) {
    return {turn.fault(error.what(), error.hint())};
  } catch (const Stopped&) {
    throw_stopped();
  }
}

}  // namespace

bool doctor(const DoctorArguments& arguments) {
  const ConfigStore settings = open_config(arguments.config);
  Config config = settings.config();
  config.scan = CalibrationStore(config.data, config.sensor).in_force(config.scan);
  const DoctorInput input{
      .rig = rig_options(arguments.rig, config),
      .config = config,
      .settings_trouble = settings.trouble(),
      .lines = is_in_use(config.data) ? LineOwner::this_program : LineOwner::another};
  load_sensor_drivers();  // changes the working directory: before the first thread
  const SignalStop signal;
  const auto expect_not_stopped = [&] {
    if (signal.token().stop_requested()) {
      throw_stopped(arguments.zip ? "no archive was written" : "");
    }
  };
  const SensorReading reading = read_sensor_from_shell(input, signal.token());
  expect_not_stopped();
  std::vector<Finding> findings = run_checks(input, reading);
  expect_not_stopped();
  if (arguments.turn) {
    std::ranges::move(check_motion(input, signal.token()), std::back_inserter(findings));
  }
  if (arguments.zip) {
    const auto files = make_diagnostics(input, settings.config(), findings, signal.token());
    expect_not_stopped();
    write_file(*arguments.zip, make_zip(files, std::chrono::system_clock::now()));
  }
  write_standard_output(arguments.json ? to_json(findings).dump() + "\n" : table_text(findings));
  return overall_state(findings) != Finding::State::fault;
}

}  // namespace octurn
