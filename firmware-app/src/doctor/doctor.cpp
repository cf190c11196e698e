#include "doctor/doctor.hpp"

#include <system_error>
#include <utility>

#include "doctor/machine_checks.hpp"
#include "doctor/permission_checks.hpp"
#include "doctor/sensor_checks.hpp"
#include "turntable/real_time.hpp"

namespace octurn {
namespace {

/// Whether the sensor is to be found on USB, and is no file.
bool is_on_usb(const std::string& uri) {
  return !is_simulated_sensor(uri) && !std::filesystem::exists(uri);
}

/// @return why the system does not allow it; empty if it does
std::string refusal_of_real_time() {
  if (const int failure = ask_for_real_time_priority(); failure != 0) {
    return std::generic_category().message(failure);
  }
  give_up_real_time_priority();
  return "";
}

std::vector<Finding> check_turntable(const Patient& patient) {
  if (!patient.rig.stepper) {
    return {check_simulated_turntable()};
  }
  const HeaderLook header = look_at_gpio(lines_of(*patient.rig.stepper));
  return {check_gpio_chip(header), check_gpio_lines(header, patient.lines),
          check_gpio_permission(patient.root), check_real_time(refusal_of_real_time())};
}

std::vector<Finding> check_machine(const Patient& patient) {
  const auto& root = patient.root;
  return {check_data_folder(patient.config.data),
          check_disk(free_bytes_in(patient.config.data), most_bytes_of(patient.config.scan)),
          check_memory(root, patient.config.limits.memory_bytes),
          check_temperature(root),
          check_supply(root),
          check_throttling(root),
          check_clock(root, std::chrono::system_clock::now(), is_clock_synchronised())};
}

}  // namespace

std::vector<Finding> examine(const Patient& patient, const SensorLook& look) {
  std::vector<Finding> findings =
      check_sensor(look, patient.config.scan.clip, patient.config.scan.platform_from_sensor);
  if (is_on_usb(patient.rig.sensor_uri)) {
    findings.push_back(check_usb(patient.root));
  }
  for (const std::vector<Finding>& more : {check_turntable(patient), check_machine(patient)}) {
    findings.insert(findings.end(), more.begin(), more.end());
  }
  return findings;
}

std::vector<Finding> examine(Patient patient, Scanner& scanner) {
  if (scanner.status().turntable.state == DeviceStatus::State::ready) {
    patient.lines = LineOwner::this_program;
  }
  SensorLook look = Failure{.code = ErrorCode::busy,
                            .detail = "not looked at: a scan is running",
                            .hint = "Check again when the scan has ended."};
  scanner.check_devices(
      [&](Rig& rig, const std::stop_token& stop) { look = look_at_sensor(rig, stop); });
  return examine(patient, look);
}

}  // namespace octurn
