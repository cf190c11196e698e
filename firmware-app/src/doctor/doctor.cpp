#include "doctor/doctor.hpp"

#include <optional>
#include <system_error>
#include <utility>

#include "calibration/calibration_store.hpp"
#include "calibration/optics_files.hpp"
#include "doctor/machine_checks.hpp"
#include "doctor/sensor_checks.hpp"
#include "store/scan_estimate.hpp"
#include "turntable/motion.hpp"
#include "turntable/real_time.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

// Number and interval of the pulses in half a second at full speed.
constexpr int wake_up_count = 400;
constexpr std::chrono::microseconds wake_up_interval(1250);

/// Whether the URI names a USB device, and neither a simulated sensor nor a file.
bool is_on_usb(const std::string& uri) {
  return !is_simulated_sensor(uri) && !std::filesystem::exists(uri);
}

/// Asks for real-time priority for a moment. @return why it was refused; empty if it was granted
std::string real_time_refusal() {
  if (const int failure = ask_for_real_time_priority(); failure != 0) {
    return std::generic_category().message(failure);
  }
  give_up_real_time_priority();
  return "";
}

/// The GPIO lines of turntable and lasers.
std::vector<NamedLine> lines_of_rig(const RigOptions& rig) {
  std::vector<NamedLine> lines = to_gpio_lines(*rig.stepper);
  if (rig.laser) {
    for (const std::string& line : to_gpio_names(*rig.laser)) {
      lines.push_back({.name = line});
    }
  }
  return lines;
}

std::vector<Finding> check_turntable(const DoctorInput& input) {
  const Lateness lateness = measure_wake_ups(wake_up_count, wake_up_interval);
  if (!input.rig.stepper) {
    return {check_simulated_turntable(), check_wake_ups(lateness, Lateness::value_type::max())};
  }
  const HeaderState header = read_gpio_header(lines_of_rig(input.rig));
  return {check_gpio_chip(header), check_gpio_lines(header, input.lines),
          check_gpio_permission(input.root), check_real_time(real_time_refusal()),
          check_wake_ups(lateness, late_after)};
}

/// Errors of the files with the page's settings and the sensor's pose; empty if there are none.
std::string stored_trouble(const DoctorInput& input) {
  const std::string damage = find_damaged_calibration(input.config.data).value_or("");
  const bool both = !damage.empty() && !input.settings_trouble.empty();
  return input.settings_trouble + (both ? "; " : "") + damage;
}

/// The sensor's pose in the sensor's own metres, without the depth scale.
Eigen::Isometry3d unscaled_pose(const ScanSettings& settings) {
  Eigen::Isometry3d pose = settings.platform_from_sensor;
  pose.translation() /= settings.depth_scale;
  return pose;
}

/// Rectifies a sample's frames for the sensor's known optics, with which the calibration was made.
SensorReading with_known_optics(SensorReading reading, const std::filesystem::path& data) {
  auto* const sample = std::get_if<SensorSample>(&reading);
  const auto optics = sample != nullptr ? optics_in_force(data, sample->serial) : std::nullopt;
  if (optics) {
    for (DepthFrame& frame : sample->frames) {
      frame = rectified(std::move(frame), sample->intrinsics, *optics);
    }
    sample->intrinsics = rectified(sample->intrinsics, *optics);
  }
  return reading;
}

std::vector<Finding> check_machine(const DoctorInput& input) {
  const auto& root = input.root;
  const std::uint64_t largest = max_scan_bytes(input.config.scan);
  std::vector<Finding> findings{
      check_data_folder(input.config.data), check_settings(stored_trouble(input)),
      check_disk(free_bytes_in(input.config.data),
                 {.largest = largest, .usual = input.usual_scan_bytes.value_or(largest)}),
      check_memory(root, input.config.limits.memory_bytes), check_temperature(root)};
  for (const std::optional<Finding>& told : {check_supply(root), check_throttling(root)}) {
    if (told) {
      findings.push_back(*told);
    }
  }
  findings.push_back(
      check_clock(root, std::chrono::system_clock::now(), is_clock_synchronised(root)));
  return findings;
}

}  // namespace

DoctorInput doctor_input(const RigOptions& rig, const ConfigStore& settings,
                         const CalibrationStore& calibration, const ScanStore& store) {
  Config config = settings.config();
  config.scan = calibration.in_force(config.scan);
  const ScanEstimate estimate = estimate_scan(earlier_scans(store), config.scan);
  return {.rig = rig,
          .config = config,
          .settings_trouble = settings.trouble(),
          .usual_scan_bytes = estimate.is_measured && estimate.bytes > 0
                                  ? std::optional(estimate.bytes)
                                  : std::nullopt};
}

std::vector<Finding> run_checks(const DoctorInput& input, const SensorReading& reading) {
  std::vector<Finding> findings =
      check_sensor(with_known_optics(reading, input.config.data), input.config.scan.clip,
                   unscaled_pose(input.config.scan),
                   first_line(input.root / "proc/device-tree/model").value_or(""));
  if (!input.rig.laser && is_on_usb(input.rig.sensor_uri)) {
    findings.push_back(check_usb(input.root));
  }
  for (const std::vector<Finding>& more : {check_turntable(input), check_machine(input)}) {
    findings.insert(findings.end(), more.begin(), more.end());
  }
  return findings;
}

std::vector<Finding> find_machine_warnings(const DoctorInput& input) {
  std::vector<Finding> findings = check_machine(input);
  std::erase_if(findings, [](const Finding& finding) {
    return finding.state != Finding::State::warning && finding.state != Finding::State::fault;
  });
  return findings;
}

std::vector<Finding> run_checks(DoctorInput input, Scanner& scanner) {
  if (scanner.has_turntable()) {
    input.lines = LineOwner::this_program;
  }
  SensorReading reading = Failure{.code = ErrorCode::busy,
                                  .detail = "not checked: a scan is running",
                                  .hint = "Check again when the scan has ended."};
  scanner.check_devices(
      [&](Rig& rig, const std::stop_token& stop) { reading = read_sensor(rig, stop); });
  return run_checks(input, reading);
}

}  // namespace octurn
