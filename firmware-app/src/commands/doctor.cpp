#include "doctor/doctor.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands/commands.hpp"
#include "doctor/diagnostics.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "signal_stop.hpp"
#include "standard_output.hpp"
#include "zip_archive.hpp"

namespace octurn {
namespace {

constexpr std::size_t state_width = std::string_view("warning").size();

/// How a terminal shows a state: green, yellow, red, dim.
std::string_view colour_of(Finding::State state) {
  constexpr std::array<std::string_view, 4> colours{"\033[32m", "\033[33m", "\033[31m", "\033[2m"};
  return colours[static_cast<std::size_t>(state)];
}

std::string padded(std::string_view text, std::size_t width) {
  return std::string(text) + std::string(width - std::min(width, text.size()), ' ');
}

std::string state_text(Finding::State state, bool in_colour) {
  const std::string text = padded(name_of(state), state_width);
  return in_colour ? std::string(colour_of(state)) + text + "\033[0m" : text;
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

/// The sensor's own look, unless a daemon that works here has the sensor.
SensorLook look_from_shell(const Patient& patient, const std::stop_token& stop) {
  if (patient.lines == LineOwner::this_program && patient.rig.stepper) {
    return Failure{.code = ErrorCode::busy,
                   .detail = "not looked at: the Octurn that is running here uses it",
                   .hint = "Open its page and choose Check the scanner."};
  }
  Rig rig(patient.rig);
  return look_at_sensor(rig, stop);
}

}  // namespace

bool doctor(const DoctorArguments& arguments) {
  const Config config = make_config(arguments.config);
  const Patient patient{
      .rig = rig_options(arguments.rig, config.turntable),
      .config = config,
      .lines = is_in_use(config.data) ? LineOwner::this_program : LineOwner::another};
  load_sensor_drivers();  // before the first thread, as it asks
  const SignalStop signal;
  const SensorLook look = look_from_shell(patient, signal.token());
  if (signal.token().stop_requested()) {
    throw_stopped();
  }
  const std::vector<Finding> findings = examine(patient, look);
  if (arguments.zip) {
    write_file(*arguments.zip,
               zip_of(diagnostics_of_machine(config, findings), std::chrono::system_clock::now()));
  }
  write_standard_output(arguments.json ? json_of(findings).dump() + "\n" : table_text(findings));
  return worst(findings) != Finding::State::fault;
}

}  // namespace octurn
